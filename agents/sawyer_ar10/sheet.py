"""One labelled picture of the hand in all 15 topologies, open and closed, for the README."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.agents.sawyer_ar10.studio import PALM_DOWN, Studio, posture
from maniskill_taskgrasp.agents.sawyer_ar10.topology_table import topology_pairs
from maniskill_taskgrasp.topology import TOPOLOGIES, Topology

SHEET_FILE = "topologies.png"
COLUMNS = 3
PICTURE = (220, 260)  # [px] width and height of one hand.
CAPTION = 32  # [px] height of the line of text below a pair.
GAP = 10  # [px] between pairs.
EYE = (-0.68, 0.38, 0.25)  # [m] in hand_base: from the thumb's side, a little before the palm.
COLOURS = 96  # Of the palette, which keeps the file small.
PAPER, INK, FAINT = (255, 255, 255), (30, 30, 30), (110, 110, 110)
NOT_FORMED = " (this hand cannot)"


def render_sheet(folder: Path) -> Path:
    """Write `topologies.png` into a folder, which is made if absent; returns its path."""
    studio = Studio()
    cells = [_cell(studio, topology) for topology in TOPOLOGIES]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / SHEET_FILE
    partial = path.with_name(f".{path.name}.part.png")
    sheet = arrange(cells, COLUMNS, GAP)
    sheet.quantize(COLOURS, dither=Image.Dither.NONE).save(partial, optimize=True)
    partial.replace(path)
    return path


def _cell(studio: Studio, topology: Topology) -> Image.Image:
    """The hand's preshape, and its closing up to the first touch, with a label below."""
    hand = AR10.postures[topology.slug]
    preshape, closing = np.array(hand.preshape), np.array(hand.closing)
    activation = min(pair.contact for pair in topology_pairs()[topology.slug])
    pictures = []
    for angles in (preshape, preshape + activation * (closing - preshape)):
        studio.pose(posture(PALM_DOWN, angles.tolist()))
        pictures.append(studio.hand_picture(EYE, PICTURE))
    label = f"{topology.index + 1}  {topology.name}{'' if hand.feasible else NOT_FORMED}"
    pair = Image.fromarray(np.concatenate(pictures, axis=1))
    cell = Image.new("RGB", (pair.width, pair.height + CAPTION), PAPER)
    cell.paste(pair)
    text = ImageDraw.Draw(cell)
    font = ImageFont.load_default(size=CAPTION * 0.6)
    text.text((pair.width / 2, pair.height + CAPTION / 2), label, INK, font, anchor="mm")
    small = ImageFont.load_default(size=CAPTION * 0.45)
    for at, state in enumerate(("open", "closed")):
        text.text((at * PICTURE[0] + CAPTION / 4, CAPTION / 4), state, FAINT, small)
    return cell


def arrange(cells: list[Image.Image], columns: int, gap: int) -> Image.Image:
    """Cells of one size row by row on white, `gap` pixels apart and around."""
    width, height = cells[0].size
    rows = -(-len(cells) // columns)
    size = (columns * (width + gap) + gap, rows * (height + gap) + gap)
    sheet = Image.new("RGB", size, PAPER)
    for i, cell in enumerate(cells):
        row, column = divmod(i, columns)
        sheet.paste(cell, (gap + column * (width + gap), gap + row * (height + gap)))
    return sheet
