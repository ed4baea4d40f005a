"""The bench and the actuator, drawn: Fig. 1 A (oblique view) and B (cross-section).

Lengths are mm on the page. The drawings carry no measured value; those come from datasets.
"""

from math import cos, radians, sin, tan
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, Ellipse, FancyBboxPatch, Polygon, Rectangle
from numpy.typing import NDArray

from dea.figures import style

_FILM, _ELECTRODE, _PERSPEX, _STEEL = "#F3E3B5", "#3C3C3C", "#CFE3EE", "#9AA3AB"
_CASE, _EDGE, _LASER = "#F4F4F4", "#444444", "#D0021B"
_SIGNAL, _HIGH_VOLTAGE = style.BLUE, style.VERMILION
Point = tuple[float, float] | NDArray[np.float64]
_FLATTEN = 0.40  # height over width of a circle seen obliquely


def draw_bench(ax: Axes) -> None:
    """Draw host, Modbus device, amplifier, actuator and laser sensor with their signals."""
    _canvas(ax, (0, 104), (0, 59))
    _actuator(ax, x=83, y=23)
    _laser(ax, x=83, ball=24.5)
    _host(ax)
    _box(ax, 30, 16, 20, 29, "Modbus\ndevice", at=(40, 40.5))
    _box(ax, 31.5, 28, 17, 7, "ADC (input)")
    _box(ax, 31.5, 18.5, 17, 7, "DAC (output)")
    _amplifier(ax, x=46, y=3)
    _arrow(ax, [(17.5, 30), (30, 30)], style.GREY, both=True)
    ax.text(23.7, 31.2, "Modbus\nTCP", ha="center", va="bottom", fontsize=6, color=style.GREY)
    _arrow(ax, [(38, 18.5), (38, 8.5), (46, 8.5)], _SIGNAL)
    ax.text(37.2, 11, "input $u$\n(voltage)", ha="right", va="center", color=_SIGNAL)
    _arrow(ax, [(75, 51.5), (56, 51.5), (56, 31.5), (48.5, 31.5)], _SIGNAL)
    ax.text(53, 53, "output $y$ (displacement)", ha="center", va="bottom", color=_SIGNAL)


def draw_cone(ax: Axes) -> None:
    """Draw the film under the ball in cross-section, with the symbols of the membrane model."""
    _canvas(ax, (-36, 38), (-38, 20))
    b, radius, slope = 27.0, 8.0, radians(28)
    contact = radius * sin(slope)
    y = (b - contact) * tan(slope)
    centre = -y + radius * cos(slope)
    edge = np.array([17.0, -(b - 17.0) * tan(slope)])  # of the electrodes
    for side in (-1, 1):
        ax.add_patch(Rectangle((side * b - (6 if side < 0 else 0), -1.6), 6, 5.2, fc=_PERSPEX,
                               ec=_EDGE, lw=0.6, zorder=4))  # fmt: skip
    ax.plot([-b, b], [0, 0], ls=(0, (4, 3)), lw=0.6, color=style.GREY)
    angle = np.linspace(-slope, slope, 41)
    cap = np.column_stack([radius * np.sin(angle), centre - radius * np.cos(angle)])
    disc = np.vstack([edge * (-1, 1), cap, edge])
    ax.plot(*disc.T, color=_ELECTRODE, lw=4.4, solid_capstyle="butt", zorder=2)
    profile = np.vstack([(-b, 0), cap, (b, 0)])
    ax.plot(*profile.T, color=_EDGE, lw=2.4, solid_joinstyle="round", zorder=2)
    ax.plot(*profile.T, color=_FILM, lw=1.8, solid_joinstyle="round", zorder=2)
    _ball(ax, 0, centre, radius)
    ax.plot([0, 0], [-33, 15], ls=(0, (6, 2, 1, 2)), lw=0.5, color=style.GREY, zorder=6)

    _dimension(ax, (0, 10), (b, 10), "$b$")
    _dimension(ax, (0, -23), (contact, -23), "$r_c$", below=True)
    _dimension(ax, (0, -29), (edge[0], -29), r"$a\,x$", below=True)
    ax.plot([contact] * 2, [-y, -24], lw=0.4, color=style.GREY)
    ax.plot([edge[0]] * 2, [edge[1] - 1, -30], lw=0.4, color=style.GREY)
    ax.plot([b, b], [3.6, 11], lw=0.4, color=style.GREY)
    _dimension(ax, (-14, 0), (-14, -y), "$y$", label_at=(-16, -y * 0.8))
    ax.plot([-contact, -15], [-y, -y], lw=0.4, color=style.GREY)
    _force(ax, (0, centre - radius), (0, centre - radius - 8), "$m g$", (-1.2, -19), ha="right")
    along = np.array([cos(slope), sin(slope)])
    start = np.array([contact, -y]) + 3 * along + (1.1, -2.1)
    _force(ax, start, start + 8 * along, "$N$", (12.5, -12.8))
    _source(ax, edge, slope)
    ax.annotate("$h$", xy=(-edge[0] + 1.5 * along[0], edge[1] - 1.5 * along[1]),
                xytext=(-24, -14), ha="center", va="center",
                arrowprops={"arrowstyle": "-", "lw": 0.5, "shrinkA": 1, "shrinkB": 0})  # fmt: skip
    ax.text(-17, 12, "frame", ha="right", va="bottom")
    ax.plot([-19, -28], [12, 3.8], lw=0.4, color=style.GREY)
    ax.text(-8.5, 14.5, "ball", ha="right", va="bottom")
    ax.plot([-9.3, -4.6], [14.5, centre + radius * 0.8], lw=0.4, color=style.GREY)
    ax.text(-35, -30, r"$k=2\pi/\int\,\mathrm{d}r/(rN)$", ha="left", va="center")
    ax.text(-35, -36, r"$h=H_0/(\lambda_p x)^2$", ha="left", va="center")


def _canvas(ax: Axes, x: tuple[float, float], y: tuple[float, float]) -> None:
    ax.set(xlim=x, ylim=y, aspect="equal")
    ax.axis("off")


def _box(
    ax: Axes, x: float, y: float, width: float, height: float, text: str,
    at: tuple[float, float] | None = None,
) -> None:  # fmt: skip
    ax.add_patch(FancyBboxPatch((x, y), width, height, boxstyle="round,pad=0,rounding_size=1.2",
                                fc=_CASE, ec=_EDGE, lw=0.7))  # fmt: skip
    ax.text(*(at or (x + width / 2, y + height / 2)), text, ha="center", va="center", fontsize=6.3)


def _arrow(ax: Axes, points: list[tuple[float, float]], color: str, *, both: bool = False) -> None:
    x, y = zip(*points, strict=True)
    ax.plot(x, y, color=color, lw=0.9, solid_capstyle="round", solid_joinstyle="round")
    for tip, before in [(points[-1], points[-2])] + [(points[0], points[1])] * both:
        ax.annotate("", tip, before, arrowprops={"arrowstyle": "-|>", "color": color, "lw": 0.9,
                                                 "shrinkA": 0, "shrinkB": 0,
                                                 "mutation_scale": 6})  # fmt: skip


def _host(ax: Axes) -> None:
    ax.add_patch(FancyBboxPatch((3.5, 26), 14, 9.5, boxstyle="round,pad=0,rounding_size=0.8",
                                fc=_EDGE, ec=_EDGE, lw=0.6))  # fmt: skip
    ax.add_patch(Rectangle((4.4, 27), 12.2, 7.6, fc="#E9F1F7", ec="none"))
    t = np.linspace(0, 1, 80)
    wave = 30.8 + 2.2 * np.sin(9 * t) * np.sin(23 * t + 1)
    ax.plot(5.2 + 10.6 * t, wave, color=_SIGNAL, lw=0.7)
    ax.add_patch(Polygon([(1.8, 23.4), (19.2, 23.4), (17.5, 26), (3.5, 26)], fc="#BDBDBD",
                         ec=_EDGE, lw=0.6))  # fmt: skip
    ax.text(10.5, 21.8, "host\n(Modbus client)", ha="center", va="top")


def _amplifier(ax: Axes, x: float, y: float) -> None:
    ax.add_patch(Polygon([(x, y), (x, y + 11), (x + 12, y + 5.5)], fc=_CASE, ec=_EDGE, lw=0.8,
                         joinstyle="round"))  # fmt: skip
    ax.text(x + 4.2, y + 5.5, "HV", ha="center", va="center", fontweight="bold")
    ax.text(x + 4.5, y - 0.6, "amplifier", ha="center", va="top")


def _actuator(ax: Axes, x: float, y: float) -> None:
    """Draw the frame on its posts, the film with its electrode, and the ball."""
    outer, inner, electrode, ball, thickness = 19.0, 14.8, 11.2, 3.4, 2.4
    for dx, depth in ((-13.5, 0.62), (13.5, 0.62)):
        ax.add_patch(Rectangle((x + dx - 0.9, 5.6), 1.8, y - 5.6 - depth * 7.6, fc=_STEEL,
                               ec=_EDGE, lw=0.5, zorder=2))  # fmt: skip
    ax.add_patch(FancyBboxPatch((x - 18.5, 3), 37, 2.6, boxstyle="round,pad=0,rounding_size=0.6",
                                fc=_PERSPEX, ec=_EDGE, lw=0.6, zorder=2))  # fmt: skip
    rim = {"ec": _EDGE, "lw": 0.6, "zorder": 3}
    ax.add_patch(_disc(x, y - thickness, outer, fc="#A9C7D8", **rim))
    ax.add_patch(Rectangle((x - outer, y - thickness), 2 * outer, thickness, fc="#A9C7D8",
                           ec="none", zorder=3))  # fmt: skip
    for side in (-outer, outer):
        ax.plot([x + side] * 2, [y - thickness, y], color=_EDGE, lw=0.6, zorder=3)
    ax.add_patch(_disc(x, y, outer, fc=_PERSPEX, **rim))
    ax.add_patch(_disc(x, y, inner, fc=_FILM, **rim))
    dip = 4.6
    for r in np.linspace(electrode, ball * 0.8, 46):
        depth = dip * (electrode - r) / (electrode - ball * 0.8)
        shade = 0.20 + 0.22 * (r / electrode) ** 1.5
        ax.add_patch(_disc(x, y - depth * 0.8, r, fc=(shade,) * 3, ec="none", zorder=3))
    ax.add_patch(_disc(x, y, electrode, fc="none", ec=_EDGE, lw=0.4, zorder=3))
    _ball(ax, x, y - dip * 0.8 + ball * 0.75, ball)
    live = [(58, 8.5), (61.5, 8.5), (61.5, 23.6), (x - 10.2, 23.6)]
    ax.plot(*zip(*live, strict=True), color=_HIGH_VOLTAGE, lw=0.9, zorder=4)
    ax.add_patch(Circle(live[-1], 0.5, fc=_HIGH_VOLTAGE, ec="none", zorder=4))
    ax.text(60.7, 14, "kV", ha="right", va="center", color=_HIGH_VOLTAGE, fontweight="bold")
    ax.plot([x, x], [y - thickness - outer * _FLATTEN, 10.2], color=_EDGE, lw=0.7)
    for half, level in ((2.0, 10.2), (1.3, 9.4), (0.6, 8.6)):
        ax.plot([x - half, x + half], [level] * 2, color=_EDGE, lw=0.7)
    for tip, at, text in (
        ((x + 8.4, y + 0.8), (93.5, 35.2), "electrodes"),
        ((x + 12.9, y - 0.6), (101, 11.2), "film"),
        ((x + 17.3, y + 0.4), (101.3, 30.8), "frame"),
        ((x - 2.4, y + 1.6), (71.5, 34.0), "ball"),
    ):
        ax.annotate(text, tip, at, ha="center", va="center", zorder=7,
                    arrowprops={"arrowstyle": "-", "lw": 0.5, "color": style.GREY,
                                "shrinkA": 0, "shrinkB": 0})  # fmt: skip


def _laser(ax: Axes, x: float, ball: float) -> None:
    """Draw the sensor head, its beam and the reflection."""
    _box(ax, x - 8, 46.5, 16, 10, "laser\nsensor")
    for window in (x - 1.2, x + 4.6):
        ax.add_patch(Rectangle((window, 45.7), 2.4, 0.9, fc=_EDGE, ec="none"))
    ax.plot([x, x], [45.7, ball], color=_LASER, lw=1.0, zorder=6)
    ax.plot([x, x + 5.8], [ball, 45.7], color=_LASER, lw=0.6, alpha=0.55, zorder=6)
    ax.add_patch(Ellipse((x, ball), 0.9, 0.6, fc=_LASER, ec="none", zorder=7))


def _disc(x: float, y: float, radius: float, **look: Any) -> Ellipse:
    return Ellipse((x, y), 2 * radius, 2 * radius * _FLATTEN, **look)


def _ball(ax: Axes, x: float, y: float, radius: float) -> None:
    """Draw a steel ball, lit from the upper left."""
    dark, light = np.array(to_rgb("#6B747C")), np.array(to_rgb("#F7F9FA"))
    for k in np.linspace(0, 1, 28):
        shift = 0.32 * radius * k
        colour = tuple(dark + (light - dark) * k**1.6)
        ax.add_patch(Circle((x - shift, y + shift), radius * (1 - 0.92 * k), fc=colour, ec="none",
                            zorder=5))  # fmt: skip
    ax.add_patch(Circle((x, y), radius, fc="none", ec=_EDGE, lw=0.6, zorder=5))


def _dimension(
    ax: Axes, start: tuple[float, float], end: tuple[float, float], text: str,
    *, below: bool = False, label_at: tuple[float, float] | None = None,
) -> None:  # fmt: skip
    ax.annotate("", start, end, arrowprops={"arrowstyle": "<|-|>", "lw": 0.6, "color": _EDGE,
                                            "shrinkA": 0, "shrinkB": 0,
                                            "mutation_scale": 5})  # fmt: skip
    x, y = label_at or ((start[0] + end[0]) / 2, start[1] + (-0.8 if below else 0.8))
    ax.text(x, y, text, ha="center", va="center" if label_at else "top" if below else "bottom")


def _force(
    ax: Axes, start: Point, end: Point, text: str, at: tuple[float, float], ha: str = "left"
) -> None:
    ax.annotate("", tuple(end), tuple(start), zorder=7, arrowprops={
        "arrowstyle": "-|>", "lw": 1.2, "color": style.GREEN, "shrinkA": 0, "shrinkB": 0,
        "mutation_scale": 7})  # fmt: skip
    ax.text(*at, text, ha=ha, va="center", color=style.GREEN)


def _source(ax: Axes, edge: Point, slope: float) -> None:
    """Draw the film voltage across the electrodes, at their right-hand edge."""
    colour = _HIGH_VOLTAGE
    contact = np.array(edge) - 1.5 * np.array([cos(slope), sin(slope)])
    normal = np.array([-sin(slope), cos(slope)])
    upper, lower = contact + 0.9 * normal, contact - 0.9 * normal
    ax.plot(
        [upper[0], upper[0], 35, 35], [upper[1], 6.5, 6.5, -4.4], color=colour, lw=0.8, zorder=6
    )
    ax.plot(
        [lower[0], lower[0], 35, 35], [lower[1], -11, -11, -7.4], color=colour, lw=0.8, zorder=1
    )
    ax.add_patch(Circle((35, -5.9), 1.5, fc="white", ec=colour, lw=0.8, zorder=7))
    ax.text(33, -6.1, "$V_f$", ha="right", va="center", color=colour)
