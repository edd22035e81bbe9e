"""Fonts and colours of all pictures, ready for print and safe for the colour-blind."""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.colors import ListedColormap

STYLE = {
    "font.size": 11,
    "axes.labelsize": 12,
    "axes.titlesize": 12,
    "figure.titlesize": 13,
    "legend.fontsize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.fonttype": "none",  # text stays text
    "pdf.fonttype": 42,
}
#: the light half of the greys, on which the colours stand out
STRESS_COLOURS = ListedColormap(matplotlib.colormaps["Greys"](np.linspace(0.0, 0.6, 256)))
#: Okabe and Ito's palette, safe for the colour-blind
PALETTE = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00")
#: what is most critical
CRITICAL = "#D55E00"
