//! The world of a preview: a start with 64 voxels a side, and a hand that works on it.

use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_core::volume::BitGrid;
use paros_core::{HiddenFigure, RangeMaps, StartVolumes, TickInput, World};
use paros_shaders::limits::PANEL_CELL_TEXELS;
use paros_shaders::scene::{LatestInput, SceneAssembler};
use paros_shaders::{Camera, Image, LitRoom, RenderOptions, render_image, render_image_in_room};
use paros_shell::figures::{Figure, HiddenStart, StoneThickness};
use paros_shell::tick_runner::TickRunner;

use crate::lathe::{LatheHand, LatheWork};

/// Voxels along a side of a preview's volume.
pub(crate) const SIDE: usize = 64;

type Maps = RangeMaps<SIDE, INTERVALS>;

/// Elevation of the eye above the stool's top, in radians.
const ELEVATION: f32 = 0.2;

/// Distance of the eye in sides of the box. The hand is visible too.
const DISTANCE: f32 = 3.5;

/// The side from which still pictures are drawn, in radians.
const AZIMUTH: f32 = 0.35;

/// The content of a preview: a figure, or a stone with a hidden figure. Operators' own figures and the
/// visitor's own volume have no preview, as their volumes aren't made here.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum PreviewSubject {
    /// The free stone.
    Stone,
    /// The creative mode's shape.
    Shape,
    /// A hidden figure.
    Hidden(HiddenStart),
}

impl PreviewSubject {
    /// Returns the subject of a start; `None` if it has no preview.
    pub(crate) fn of_start(start: SessionMode) -> Option<Self> {
        match start {
            SessionMode::None | SessionMode::FreeForm => Some(PreviewSubject::Stone),
            SessionMode::Creative => Some(PreviewSubject::Shape),
            SessionMode::Constrained { figure } => {
                HiddenStart::from_number(figure).map(PreviewSubject::Hidden)
            }
            SessionMode::Own => None,
        }
    }

    /// Returns the figure of a still picture.
    const fn still_figure(self) -> Figure {
        match self {
            PreviewSubject::Stone => Figure::Lump,
            PreviewSubject::Shape => Figure::Toy,
            PreviewSubject::Hidden(start) => start.figure,
        }
    }

    const fn work(self) -> LatheWork {
        match self {
            PreviewSubject::Stone => LatheWork::Vase,
            PreviewSubject::Shape => LatheWork::Waist,
            // The bit is 80 mm wide.
            PreviewSubject::Hidden(start) => LatheWork::Bare {
                passes: match start.thickness {
                    StoneThickness::Whole => 6,
                    StoneThickness::Half => 5,
                    StoneThickness::Near => 4,
                },
            },
        }
    }

    /// Writes the volume that a session starts from, and its hidden figure, if there is one.
    fn rasterize_into(self, stone: &mut Maps, figure: &mut Maps) {
        let mut scratch = Box::new(BitGrid::new());
        match self {
            PreviewSubject::Stone | PreviewSubject::Shape => {
                self.still_figure().rasterize_into(stone, &mut scratch);
            }
            PreviewSubject::Hidden(start) => {
                Figure::Lump.rasterize_into(stone, &mut scratch);
                start.rasterize_stone_into(stone, &mut scratch);
                start.figure.rasterize_into(figure, &mut scratch);
            }
        }
    }
}

/// A live preview: a start that turns and is worked on. Begins again once the work is done.
#[derive(Debug)]
pub(crate) struct PreviewStage {
    subject: PreviewSubject,
    world: Box<World<SIDE, INTERVALS>>,
    stone: Box<Maps>,
    figure: Box<Maps>,
    hand: LatheHand,
    scene: SceneAssembler,
}

impl PreviewStage {
    /// Makes a preview before its first tick.
    pub(crate) fn new(subject: PreviewSubject) -> Self {
        let mut stage = PreviewStage {
            subject,
            world: Box::new(World::new()),
            stone: Box::new(RangeMaps::new()),
            figure: Box::new(RangeMaps::new()),
            hand: LatheHand::new(subject.work()),
            scene: SceneAssembler::new(),
        };
        subject.rasterize_into(&mut stage.stone, &mut stage.figure);
        stage
    }

    /// Returns the world of the preview.
    #[cfg(test)]
    pub(crate) const fn world(&self) -> &World<SIDE, INTERVALS> {
        &self.world
    }

    /// Returns `true` if no voxel of the hidden figure is missing.
    #[cfg(test)]
    pub(crate) fn figure_is_whole(&self) -> bool {
        let mut all = (0..SIDE.pow(3)).map(|k| [k % SIDE, k / SIDE % SIDE, k / SIDE / SIDE]);
        let rows = self.world.volume().rows();
        all.all(|voxel| !self.figure.contains(voxel) || rows.contains(voxel))
    }

    /// Steps the world by one tick of the hand.
    pub(crate) fn run_tick(&mut self) {
        if self.hand.is_done() {
            self.hand = LatheHand::new(self.subject.work());
            self.world.clear();
        }
        let mut input = TickInput::default();
        if self.world.tick() == 0 {
            input.start = match self.subject {
                PreviewSubject::Stone => SessionMode::FreeForm,
                PreviewSubject::Shape => SessionMode::Creative,
                PreviewSubject::Hidden(_) => SessionMode::Constrained { figure: 0 },
            };
        } else {
            self.hand.fill_input(&self.world, &mut input);
        }
        let hidden = [HiddenFigure { figure: &self.figure, stone: &self.stone }];
        let starts =
            StartVolumes { lump: &self.stone, figures: &hidden, creative: &self.stone, own: None };
        TickRunner::new(&mut self.world, starts).run_tick(&input);
    }

    /// Draws the current picture for a cell, with the hand and its tool.
    pub(crate) fn draw(&mut self) -> Image {
        let latest = LatestInput { show_hands: true, tick_fraction: 1.0, ..LatestInput::default() };
        self.scene.assemble_frame(&self.world, &latest);
        let placement = self.scene.sculpture_placement();
        let hands = LitRoom::of_hands_in_studio(self.scene.draw_list(), placement);
        let camera = camera_at(-placement.turn_radians);
        render_image_in_room(self.world.volume().maps(), &camera, &options(), &hands, &|_| {})
    }
}

/// Draws the still picture of a start for a cell.
pub(crate) fn draw_still(subject: PreviewSubject) -> Image {
    let (mut maps, mut scratch): (Box<Maps>, _) =
        (Box::new(RangeMaps::new()), Box::new(BitGrid::new()));
    subject.still_figure().rasterize_into(&mut maps, &mut scratch);
    render_image(&maps, &camera_at(AZIMUTH), &options(), &|_| {})
}

fn camera_at(azimuth: f32) -> Camera {
    Camera { distance: DISTANCE, ..Camera::orbiting(azimuth, ELEVATION) }
}

fn options() -> RenderOptions {
    let side = PANEL_CELL_TEXELS;
    RenderOptions { width: side, height: side, samples: 1, ..RenderOptions::default() }
}
