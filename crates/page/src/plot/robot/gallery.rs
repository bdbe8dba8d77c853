//! Pictures of robots in rows, all to one scale.

use super::block::{
    ACTIVE, BEND, Block, BlockKind, Motion, PASSIVE, SPIN, draw_blocks, draw_length, extent,
    seen_at,
};
use super::surface::project;
use crate::plot::kit::*;

const WIDTH: f64 = 1400.0;
const MARGIN: f64 = 28.0;
const GAP: f64 = 18.0;
const PADDING: f64 = 16.0;
const TITLE: f64 = 36.0;
const TITLE_SIZE: f64 = 23.0;
const NOTE_SIZE: f64 = 19.0;
const NOTE_LINE: f64 = 25.0;
const NOTE_LINES_AT_MOST: usize = 4;
const KEY: f64 = 92.0;
/// Height of the room for a robot as a share of its width.
const SHAPE: std::ops::RangeInclusive<f64> = 0.4..=1.05;
const TALLEST: f64 = 620.0;
/// Height of the room for a gait.
const GAIT: f64 = 118.0;
/// Widest name of a module, and the ground under it.
const NAME_AT_MOST: f64 = 150.0;
const NAME_GROUND: RGBColor = RGBColor(250, 250, 248);

/// The name of a module, on its cube.
#[derive(Debug, Clone, PartialEq)]
pub struct ModuleName {
    /// What it is called.
    pub text: String,
    /// Lower corner of the cube, metres.
    pub lower_m: [f64; 3],
    /// Upper corner of the cube, metres.
    pub upper_m: [f64; 3],
    /// Whether recordings follow this module.
    pub is_tracked: bool,
}

/// The commanded angles of a servo.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// Its name.
    pub servo: String,
    /// Angles over the time of [`Gallery::gait_s`], radians, evenly spaced.
    pub angles_rad: Vec<f64>,
}

/// One robot: blocks and two texts, its modules' names and its gait where they are to be seen.
#[derive(Debug, Clone, PartialEq)]
pub struct GalleryRobot {
    /// Its name.
    pub title: String,
    /// A line below the name, e.g. `3 modules, 0.16 m in 20 s`; may be empty.
    pub note: String,
    /// Its blocks, z up, at zero servo angles.
    pub blocks: Vec<Block>,
    /// Names that stand on the modules; none where the picture would be too small for them.
    pub names: Vec<ModuleName>,
    /// The commanded angles of each servo; empty without a gait.
    pub commands: Vec<Command>,
}

/// Robots in rows, filled from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Gallery {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// Robots side by side, 1 to 6.
    pub columns: usize,
    /// The robots, 1 to 60.
    pub robots: Vec<GalleryRobot>,
    /// Time that the commands cover, seconds.
    pub gait_s: f64,
}

/// Draws robots into a PNG or SVG file.
///
/// # Errors
/// No robot or too many, too many side by side, a path that is neither .png nor .svg, or a disk that refuses.
pub fn draw_gallery(gallery: &Gallery, path: impl AsRef<Path>) -> Result<()> {
    picture::write(gallery, path.as_ref())
}

struct Layout {
    heading: Heading,
    top: f64,
    cell_width: f64,
    head: f64,
    room_height: f64,
    /// Height of the room for commands; 0 where no robot has any.
    gait_height: f64,
    /// Pixels to a metre, for all robots.
    scale: f64,
    key_top: f64,
}

impl GalleryRobot {
    fn note_lines(&self, width: f64) -> Vec<String> {
        let weight = Weight::Regular;
        wrap(&self.note, weight, NOTE_SIZE, width, NOTE_LINES_AT_MOST)
    }

    /// Corners of its picture with the floor around, metres.
    fn extent(&self) -> (Point, Point) {
        extent(&self.blocks).unwrap_or(((0.0, 0.0), (0.0, 0.0)))
    }
}

impl Gallery {
    fn layout(&self) -> Layout {
        let heading = Heading::new(&self.caption, WIDTH - 2.0 * MARGIN);
        let columns = self.columns.min(self.robots.len()) as f64;
        let rows = self.robots.len().div_ceil(self.columns) as f64;
        let cell_width = ((WIDTH - 2.0 * MARGIN - GAP * (columns - 1.0)) / columns).floor();
        let (mut widest_m, mut tallest_m) = (1e-3_f64, 1e-3_f64);
        for (low, high) in self.robots.iter().map(GalleryRobot::extent) {
            widest_m = widest_m.max(high.0 - low.0);
            tallest_m = tallest_m.max(high.1 - low.1);
        }
        let shape = (tallest_m / widest_m).clamp(*SHAPE.start(), *SHAPE.end());
        let room_height = (cell_width * shape).min(TALLEST).round();
        let inside = cell_width - 2.0 * PADDING;
        let scale = (inside / widest_m).min((room_height - 2.0 * PADDING) / tallest_m);
        let robots = self.robots.iter();
        let notes = robots.map(|robot| robot.note_lines(inside).len());
        let head = TITLE + NOTE_LINE * notes.max().unwrap_or(0) as f64 + 6.0;
        let top = (14.0 + heading.height() + 12.0).round();
        let has_gait = self.robots.iter().any(|r| !r.commands.is_empty());
        let gait_height = if has_gait { GAIT } else { 0.0 };
        let cell_height = head + room_height + gait_height;
        Layout {
            key_top: top + rows * cell_height + (rows - 1.0) * GAP + 14.0,
            gait_height,
            heading,
            top,
            cell_width,
            head,
            room_height,
            scale,
        }
    }

    fn draw_robot(
        &self,
        canvas: &mut Canvas,
        robot: &GalleryRobot,
        (left, top): Point,
        layout: &Layout,
    ) {
        let right = left + layout.cell_width;
        let bottom = top + layout.head + layout.room_height + layout.gait_height;
        canvas.outline((left, top), (right, bottom), 1.5, GRID);
        let (low, high) = robot.extent();
        let middle = (0.5 * (low.0 + high.0), 0.5 * (low.1 + high.1));
        let (x0, y0) = (
            0.5 * (left + right),
            top + layout.head + 0.5 * layout.room_height,
        );
        let to = |start: f64, away: f64| start + layout.scale * away;
        let place = |(x, y): Point| (to(x0, x - middle.0), to(y0, y - middle.1));
        let edge = (0.03 * layout.scale * 0.058).clamp(1.0, 3.0);
        draw_blocks(canvas, &robot.blocks, &place, edge);
        draw_names(canvas, robot, &place);
        if layout.gait_height > 0.0 {
            let under = (left + PADDING, bottom - GAIT);
            self.draw_commands(canvas, robot, under, right - PADDING);
        }

        let width = layout.cell_width - 2.0 * PADDING;
        let letter = Letter::new(TITLE_SIZE, Weight::Bold, INK);
        let title = shorten(&robot.title, Weight::Bold, TITLE_SIZE, width);
        canvas.text(&title, (left + PADDING, top + 29.0), Align::Left, letter);
        let letter = Letter::new(NOTE_SIZE, Weight::Regular, FAINT_INK);
        for (index, line) in robot.note_lines(width).iter().enumerate() {
            let baseline = top + TITLE + NOTE_LINE * (index as f64 + 0.75);
            canvas.text(line, (left + PADDING, baseline), Align::Left, letter);
        }
    }

    /// The commands of each servo over time, under the robot.
    fn draw_commands(
        &self,
        canvas: &mut Canvas,
        robot: &GalleryRobot,
        (left, top): Point,
        right: f64,
    ) {
        let letter = Letter::new(16.0, Weight::Regular, FAINT_INK);
        let all = self.robots.iter().flat_map(|robot| &robot.commands);
        let all = all.flat_map(|command| &command.angles_rad);
        // One scale for all, so that they can be compared.
        let largest_rad = all.fold(0.1, |most: f64, a| most.max(a.abs()));
        let (low, high) = (top + 6.0, top + GAIT - 30.0);
        let middle = 0.5 * (low + high);
        canvas.cell((left, middle), (right, middle + 1.0), GRID);
        for (index, command) in robot.commands.iter().enumerate() {
            let Stroke { colour, dash, .. } = stroke_of(index, 1.0);
            let last = command.angles_rad.len().saturating_sub(1).max(1) as f64;
            let angles = command.angles_rad.iter().enumerate();
            let points = angles.map(|(k, angle)| {
                let x = left + (right - left) * k as f64 / last;
                (x, middle - 0.5 * (high - low) * angle / largest_rad)
            });
            let stroke = Stroke::new(2.2, colour).dashed(dash);
            canvas.path(&points.collect::<Vec<_>>(), stroke);
        }
        let baseline = top + GAIT - 10.0;
        if robot.commands.is_empty() {
            canvas.text("no gait", (left, baseline), Align::Left, letter);
            return;
        }
        let degrees = largest_rad.to_degrees();
        let text = format!("gait, ±{degrees:.0}° over {} s", self.gait_s);
        canvas.text(&text, (left, baseline), Align::Left, letter);
        // The names of the servos beside their lines, as far as there is room.
        let mut from = left + letter.width(&text) + 24.0;
        for (index, command) in robot.commands.iter().enumerate() {
            let colour = stroke_of(index, 1.0).colour;
            let letter = Letter::new(16.0, Weight::Bold, colour);
            let width = letter.width(&command.servo);
            if from + width > right {
                break;
            }
            canvas.text(&command.servo, (from, baseline), Align::Left, letter);
            from += width + 18.0;
        }
    }

    fn draw_key(&self, canvas: &mut Canvas, layout: &Layout) {
        let letter = Letter::new(20.0, Weight::Regular, INK);
        let middle = layout.key_top + 0.5 * KEY;
        let mut left = MARGIN;
        let blocks = || self.robots.iter().flat_map(|robot| &robot.blocks);
        let has = |kind| blocks().any(|block| block.kind == kind);
        let does = |motion| blocks().any(|b| b.driven.is_some_and(|d| d.motion == motion));
        let is_driven = has(BlockKind::DrivenBody);
        let entries = [
            (has(BlockKind::Passive), PASSIVE, "passive module"),
            (has(BlockKind::Active), ACTIVE, "active module"),
            (has(BlockKind::Body), PASSIVE, "body"),
            (is_driven, ACTIVE, "body that a servo moves"),
            (does(Motion::Spin), SPIN, "driven face, spins"),
            (does(Motion::Bend), BEND, "driven face, bends"),
        ];
        let say = |canvas: &mut Canvas, text: &str, left: f64| {
            canvas.text_beside(text, (left + 32.0, middle), Align::Left, letter);
            left + (32.0 + letter.width(text) + 34.0)
        };
        let mut names = self.robots.iter().flat_map(|robot| &robot.names);
        if names.any(|name| name.is_tracked) {
            draw_tracked(canvas, (left + 11.0, middle));
            left = say(canvas, "recordings follow it", left);
        }
        for (_, colour, text) in entries.into_iter().filter(|entry| entry.0) {
            let (from, to) = ((left, middle - 11.0), (left + 22.0, middle + 11.0));
            canvas.fill(from, to, colour);
            canvas.outline(from, to, 1.5, INK);
            left = say(canvas, text, left);
        }
        self.draw_axes(canvas, (WIDTH - MARGIN - 70.0, middle + 18.0));
        self.draw_scale_bar(canvas, WIDTH - MARGIN - 150.0, middle, layout.scale);
    }

    /// x, y and z as the picture shows them.
    fn draw_axes(&self, canvas: &mut Canvas, origin: Point) {
        const LENGTH: f64 = 38.0;
        let letter = Letter::new(17.0, Weight::Regular, FAINT_INK);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            let (x, y) = project(unit);
            let at = |share: f64| (origin.0 + share * LENGTH * x, origin.1 + share * LENGTH * y);
            canvas.path(&[origin, at(1.0)], Stroke::new(2.0, FAINT_INK));
            let beyond = at(1.0);
            let length = x.hypot(y);
            let label = (beyond.0 + 11.0 * x / length, beyond.1 + 11.0 * y / length);
            canvas.text_beside(name, label, Align::Centre, letter);
        }
    }

    /// A bar of a round length, across the line of sight.
    fn draw_scale_bar(&self, canvas: &mut Canvas, right: f64, middle: f64, scale: f64) {
        const LONGEST: f64 = 190.0;
        let round_m = [1.0, 2.0, 5.0]
            .into_iter()
            .flat_map(|digit| (-4..3).map(move |power| digit * 10_f64.powi(power)))
            .filter(|length_m| length_m * scale <= LONGEST)
            .fold(1e-4, f64::max);
        let left = right - round_m * scale;
        let y = middle + 12.0;
        let text = format!("{} cm", (round_m * 1e6).round() / 1e4);
        let letter = Letter::new(19.0, Weight::Regular, INK);
        draw_length(canvas, (left, right), (y, 7.0), 3.0);
        let centre = 0.5 * (left + right);
        canvas.text(&text, (centre, y - 12.0), Align::Centre, letter);
    }
}

/// Names on a pale ground, each on a visible face of its cube; the tracked module has a ring before its name. Of names that would
/// cover each other the name of the tracked module is drawn, else the first.
fn draw_names(canvas: &mut Canvas, robot: &GalleryRobot, place: &impl Fn(Point) -> Point) {
    let letter = Letter::new(18.0, Weight::Regular, INK);
    let ground = |name: &ModuleName| {
        let (x, y) = place(project(seen_at(&robot.blocks, name.lower_m, name.upper_m)));
        let text = shorten(&name.text, Weight::Regular, letter.size, NAME_AT_MOST);
        let ring = if name.is_tracked { 20.0 } else { 0.0 };
        let half = 0.5 * (letter.width(&text) + ring) + 7.0;
        ((x - half, y - 14.0), (x + half, y + 14.0), text)
    };
    let all: Vec<_> = robot.names.iter().map(ground).collect();
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|index| !robot.names[*index].is_tracked);
    let mut shown: Vec<usize> = Vec::new();
    for index in order {
        let (from, to, _) = &all[index];
        let is_covered = shown.iter().any(|other| {
            let (a, b, _) = &all[*other];
            a.0 < to.0 && from.0 < b.0 && a.1 < to.1 && from.1 < b.1
        });
        if !is_covered {
            shown.push(index);
        }
    }
    shown.sort_unstable();
    for index in shown {
        let ((left, top), to, text) = &all[index];
        let y = top + 14.0;
        canvas.fill((*left, *top), *to, NAME_GROUND);
        let is_tracked = robot.names[index].is_tracked;
        if is_tracked {
            draw_tracked(canvas, (left + 15.0, y));
        }
        let start = (left + 7.0 + if is_tracked { 20.0 } else { 0.0 }, y);
        canvas.text_beside(text, start, Align::Left, letter);
    }
}

/// The mark of a module that recordings follow.
fn draw_tracked(canvas: &mut Canvas, centre: Point) {
    canvas.ring(centre, 6.0, 2.5, INK);
    canvas.disc(centre, 2.0, INK);
}

impl Picture for Gallery {
    fn check(&self) -> Result<()> {
        picture::check_rows("robots", self.robots.len(), self.columns)
    }

    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, (self.layout().key_top + KEY).ceil() as u32)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let layout = self.layout();
        layout.heading.draw(canvas, MARGIN, 14.0);
        for (index, robot) in self.robots.iter().enumerate() {
            let (row, column) = (index / self.columns, index % self.columns);
            let left = MARGIN + column as f64 * (layout.cell_width + GAP);
            let height = layout.head + layout.room_height + layout.gait_height;
            let top = layout.top + row as f64 * (height + GAP);
            self.draw_robot(canvas, robot, (left, top), &layout);
        }
        self.draw_key(canvas, &layout);
    }
}
