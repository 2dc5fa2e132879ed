"""One turn as a moving picture, seen from above."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.body_shapes import (
    body_outlines,
    body_polygons,
    leg_lines,
    module_polygons,
    nice_step,
    sampled_at,
    turned_deg,
)
from omega_turn_lab.ground_view import LEVEL, GroundView
from omega_turn_lab.run_record import RunRecord
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.robot import Robot

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

Array = NDArray[np.float64]

FRAME_SIZE = 480  # [px]
SUPERSAMPLING = 2  # drawn larger and shrunk, which smooths the edges
MAX_FRAMES = 150
HOLD = 1500  # [ms] the last frame stays before the picture starts again


def animate_turn(
    record: RunRecord,
    robot: Robot,
    path: Path,
    frames_per_second: float = 12.0,
    speed: float = 1.0,
    ground: GroundView = LEVEL,
) -> None:
    """Write the turn as an animated GIF seen from above, the camera fixed.

    Args:
        record: the run.
        robot: the robot that made it.
        path: the GIF to write; missing folders are made.
        frames_per_second: of the picture, rounded to what GIF can say (1/100 s per frame).
        speed: seconds of the run per second watched; raised as far as a long run needs to stay
            within `MAX_FRAMES`.
        ground: what it turned on.

    Raises:
        BadInputError: a rate that is not positive, or the record is not of this robot.
    """
    for field, value in (('frames_per_second', frames_per_second), ('speed', speed)):
        if not math.isfinite(value) or value <= 0.0:
            raise BadInputError(field, value, 'a finite number > 0')
    frame_ms = max(20, round(100.0 / frames_per_second) * 10)
    times, speed = _frame_times(record.time, 1e-3 * frame_ms, speed)
    scene = _Scene(sampled_at(record, times), robot, speed, ground)
    frames = [scene.frame(i) for i in range(len(times))]
    path.parent.mkdir(parents=True, exist_ok=True)
    frames[0].save(
        path,
        save_all=True,
        append_images=frames[1:],
        duration=[frame_ms] * (len(frames) - 1) + [HOLD],
        loop=0,
        optimize=True,
    )


def _frame_times(time: Array, frame_seconds: float, speed: float) -> tuple[Array, float]:
    """Instants shown [s], first and last of the run among them, and the speed that fits them."""
    duration = float(time[-1] - time[0])
    speed = max(speed, duration / ((MAX_FRAMES - 1) * frame_seconds))
    count = max(1, math.ceil(duration / (speed * frame_seconds) - 1e-9))
    shown = time[0] + speed * frame_seconds * np.arange(count + 1)
    return np.minimum(shown, time[-1]), speed


class _Scene:
    """A run seen from a fixed camera.

    Args:
        record: the run, one sample per frame.
        robot: the robot that made it.
        speed: seconds of the run per second watched, told in the picture.
        ground: what it turned on.
    """

    PAPER, GRID, INK, FAINT = '#ffffff', '#e4e4e4', '#222222', '#8c8c8c'
    SPINE, MODULE, HEAD, TRAIL = '#3d5266', '#6d8ba6', '#e0702c', '#1f62b0'
    OBSTACLE, GRAIN = '#8f887c', '#d9c9a8'
    LYING, RIM = '#efefec', '#c8c8c4'  # rocks

    def __init__(self, record: RunRecord, robot: Robot, speed: float, ground: GroundView) -> None:
        from PIL import ImageFont

        self._record, self._robot, self._speed = record, robot, speed
        self._outlines = body_outlines(record, robot)
        self._legs, self._down = leg_lines(record, robot)
        self._turned = turned_deg(record)
        self._side = FRAME_SIZE * SUPERSAMPLING
        corners = np.concatenate([self._outlines.reshape(-1, 2), self._legs.reshape(-1, 2)])
        low, high = corners.min(axis=0), corners.max(axis=0)
        self._centre = 0.5 * (low + high)
        # The strip of text above the ground must not cover the body.
        self._view = 1.16 * float((high - low).max()) + 2.0 * robot.module_width  # [m] per side
        self._font = ImageFont.load_default(size=0.042 * self._side)
        self._small = ImageFont.load_default(size=0.03 * self._side)
        self._palette = self._make_palette()
        self._ground = self._draw_ground(ground)

    def frame(self, index: int) -> Image:
        """Draw one instant, as a palette image of FRAME_SIZE squared."""
        from PIL import Image, ImageDraw

        picture = self._ground.copy()
        draw = ImageDraw.Draw(picture)
        trail = self._pixels(self._record.pose[: index + 1, :2])
        if len(trail) > 1:
            draw.line(trail, fill=self.TRAIL, width=3 * SUPERSAMPLING // 2, joint='curve')
        for leg, stands in zip(self._legs[index], self._down[index]):
            self._draw_leg(draw, leg, stands)
        for polygon in body_polygons(self._outlines[index], 0.7 * self._robot.module_width):
            draw.polygon(self._pixels(polygon), fill=self.SPINE)
        modules = module_polygons(self._outlines[index], self._robot)
        for k, polygon in enumerate(modules):
            draw.polygon(self._pixels(polygon), fill=self.MODULE if k else self.HEAD)
        self._draw_arrow(draw, self._record.pose[index], self.INK)
        self._draw_text(draw, index)
        small = picture.resize((FRAME_SIZE, FRAME_SIZE), Image.Resampling.BOX)
        return small.quantize(palette=self._palette, dither=Image.Dither.NONE)

    def _draw_leg(self, draw: ImageDraw, leg: Array, stands: bool) -> None:
        """One leg, with a dot under a foot that is down."""
        draw.line(self._pixels(leg), fill=self.SPINE, width=4 * SUPERSAMPLING)
        if stands:
            x, y = self._pixels(leg)[1]
            radius = 4 * SUPERSAMPLING
            draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=self.HEAD)

    def _pixels(self, points: Array) -> list[tuple[float, float]]:
        """World [m] to picture [px], y up."""
        scale = self._side / self._view
        middle = 0.5 * self._side
        x = middle + scale * (points[..., 0] - self._centre[0])
        y = middle - scale * (points[..., 1] - self._centre[1])
        return list(zip(x.tolist(), y.tolist()))

    def _draw_ground(self, ground: GroundView) -> Image:
        """Grid, obstacles, scale bar and first heading: all that stays the same."""
        from PIL import Image, ImageDraw

        picture = Image.new('RGB', (self._side, self._side), self.PAPER)
        draw = ImageDraw.Draw(picture)
        step = nice_step(self._view / 12.0)
        reach = 0.5 * self._view
        for axis in (0, 1):
            first = math.ceil((self._centre[axis] - reach) / step)
            last = math.floor((self._centre[axis] + reach) / step)
            for k in range(first, last + 1):
                line = np.tile(self._centre, (2, 1))
                line[:, axis] = k * step
                line[:, 1 - axis] += (-reach, reach)
                draw.line(self._pixels(line), fill=self.GRID, width=SUPERSAMPLING)
        for x, y in self._pixels(ground.grains(self._centre - reach, self._centre + reach)):
            draw.ellipse((x - 2, y - 2, x + 2, y + 2), fill=self.GRAIN)
        fill, rim = (self.LYING, self.RIM) if ground.carries else (self.OBSTACLE, None)
        for outline in ground.obstacles:
            draw.polygon(self._pixels(outline), fill, rim, SUPERSAMPLING)
        self._draw_scale_bar(draw, step)
        self._draw_arrow(draw, self._record.pose[0], self.FAINT)
        return picture

    def _draw_scale_bar(self, draw: ImageDraw, step: float) -> None:
        length = 2.0 * step
        pixels = length * self._side / self._view
        x, y = 0.04 * self._side, 0.96 * self._side
        draw.line([(x, y), (x + pixels, y)], fill=self.INK, width=2 * SUPERSAMPLING)
        draw.text((x, y - 6), f'{length:g} m', fill=self.INK, font=self._small, anchor='lb')

    def _draw_arrow(self, draw: ImageDraw, pose: Array, colour: str) -> None:
        """Heading arrow from the mean body frame."""
        direction = np.array([math.cos(pose[2]), math.sin(pose[2])])
        side = np.array([-direction[1], direction[0]])
        length, barb = 0.35 * self._robot.length, 0.03 * self._view
        tip = pose[:2] + length * direction
        neck = tip - 1.3 * barb * direction
        draw.line(self._pixels(np.array([pose[:2], neck])), fill=colour, width=2 * SUPERSAMPLING)
        head = np.array([tip, neck + 0.5 * barb * side, neck - 0.5 * barb * side])
        draw.polygon(self._pixels(head), fill=colour)

    def _draw_text(self, draw: ImageDraw, index: int) -> None:
        edge, top = 0.04 * self._side, 0.035 * self._side
        time = self._record.time[index] - self._record.time[0]
        pace = '' if abs(self._speed - 1.0) < 0.05 else f'  (x {self._speed:.2g})'
        draw.text((edge, top), f'{time:.1f} s{pace}', fill=self.INK, font=self._font, anchor='lt')
        turned = f'turned {round(float(self._turned[index])):d}°'
        draw.text((self._side - edge, top), turned, fill=self.INK, font=self._font, anchor='rt')

    def _make_palette(self) -> Image:
        """Every colour and its steps towards paper and ink, which smoothed edges need."""
        from PIL import Image, ImageColor

        def mixed(one: str, other: str) -> list[int]:
            a, b = (np.array(ImageColor.getrgb(c), float) for c in (one, other))
            steps = np.linspace(0.0, 1.0, 7)[:, None]
            return [round(value) for value in ((1.0 - steps) * a + steps * b).ravel().tolist()]

        pairs = [(self.PAPER, c) for c in (self.INK, self.FAINT, self.TRAIL)]
        pairs += [(c, self.PAPER) for c in (self.SPINE, self.MODULE, self.HEAD)]
        pairs += [(self.SPINE, self.MODULE), (self.SPINE, self.HEAD)]
        pairs += [(c, self.INK) for c in (self.MODULE, self.HEAD, self.FAINT)]
        pairs += [(c, self.PAPER) for c in (self.OBSTACLE, self.GRAIN, self.LYING, self.RIM)]
        values = [*ImageColor.getrgb(self.GRID)]
        for pair in pairs:
            values += mixed(*pair)
        palette = Image.new('P', (1, 1))
        palette.putpalette(values)
        return palette
