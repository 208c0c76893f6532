#!/bin/sh
# Make rendering possible where we may: rendering.sh PYTHON. Never fails; physics needs no driver.
set -u
can_render() {
    "$1" - 2>/dev/null <<'PY'
import sapien.render
sapien.render.get_device_summary()
PY
}
can_render "$1" && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null && [ -r /etc/os-release ]; then
    . /etc/os-release
    export DEBIAN_FRONTEND=noninteractive
    from=
    apt-get update -qq
    if [ "${VERSION_CODENAME:-}" = bookworm ]; then
        # SAPIEN needs Mesa 24.3 or newer; Debian 12 has 22.3, its backports 25.0. They lie on the
        # mirror that this machine uses already.
        mirror=$(apt-get indextargets --format '$(REPO_URI)' "Codename: bookworm" \
            "Created-By: Packages" | sort -u | head -n 1)
        echo "deb $mirror bookworm-backports main" >/etc/apt/sources.list.d/bookworm-backports.list
        from="-t bookworm-backports"
        apt-get update -qq
    fi
    echo "rendering: installing a software Vulkan driver"
    apt-get install -y -qq --no-install-recommends libvulkan1 libgl1 libglib2.0-0 libx11-6 >/dev/null
    # shellcheck disable=SC2086
    apt-get install -y -qq --no-install-recommends $from mesa-vulkan-drivers >/dev/null
    can_render "$1" && exit 0
fi
echo "rendering: off, no Vulkan driver that SAPIEN can use was found; simulation works without." >&2
echo "rendering: for video install a GPU driver with Vulkan, or Mesa 24.3 or newer" >&2
echo "rendering: (package mesa-vulkan-drivers on Debian and Ubuntu)." >&2
exit 0
