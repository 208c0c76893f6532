"""`python -m maniskill_taskgrasp` is `taskgrasp`."""

from maniskill_taskgrasp.cli import main

if __name__ == "__main__":
    main()
