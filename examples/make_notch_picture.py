"""Draws notch.png: a plate of 60 mm x 60 mm with a lobed hole, 600 x 600 pixels with antialiased edges."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from slmm.scene.gallery import lobes

PIXELS, PIXEL_SIZE = 600, 0.1
SUBPIXELS = 8  # per pixel and direction; their mean is the grey value


def main() -> None:
    """Write the picture next to this script."""
    plate = PIXELS * PIXEL_SIZE
    x, y = np.array(lobes(center=(plate / 2, plate / 2), radius=11.0)).T
    # the top row of the picture is the top of the plate; Pillow counts from the middle of the subpixels
    corners = np.column_stack([x, plate - y]) / PIXEL_SIZE * SUBPIXELS - 0.5
    picture = Image.new("L", (PIXELS * SUBPIXELS, PIXELS * SUBPIXELS), 255)
    ImageDraw.Draw(picture).polygon([tuple(corner) for corner in corners], fill=0)
    picture.resize((PIXELS, PIXELS), Image.Resampling.BOX).save(Path(__file__).with_name("notch.png"))


if __name__ == "__main__":
    main()
