//! Episodes to be drawn.

/// Cells along each side of a map.
pub const CELLS: usize = 16;

/// What a policy observes of the obstacles within 6 m by 6 m: `map[row][column]` is 0 if that cell
/// is free, 255 if it is blocked. Rows count forwards from the farthest behind the character (z from
/// −3 m to 3 m in its frame), columns from its right to its left (x from −3 m to 3 m); the
/// character stands in the middle.
pub type Map = [[u8; CELLS]; CELLS];

/// An axis-aligned box that moves: world x and z, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Obstacle {
    /// Its centre when the episode began.
    pub start: [f32; 2],
    /// Its centre when the episode ended.
    pub end: [f32; 2],
    /// Half its size along x and z.
    pub half: [f32; 2],
}

/// How an episode ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum End {
    /// At the target.
    Reached,
    /// In an obstacle.
    Collided,
    /// Not yet.
    #[default]
    UnderWay,
}

/// One episode, on the way to one target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnEpisode {
    /// What the panel shows, such as "level 9".
    pub title: String,
    /// All obstacles.
    pub obstacles: Vec<Obstacle>,
    /// The root's ground position at the start and after every step: world x and z, in
    /// metres.
    pub points: Vec<[f32; 2]>,
    /// World x and z of the target, in metres.
    pub target: [f32; 2],
    /// How it ended.
    pub end: End,
    /// Index into `points` of the position where the maps were observed.
    pub seen: usize,
    /// The character's forward direction then: world x and z, of any length.
    pub heading: [f32; 2],
    /// The maps observed then and a step before.
    pub maps: [Map; 2],
}

/// The time of so many steps, in words.
pub(super) fn seconds(steps: usize, step_s: f32) -> String {
    format!("{:.1} s", steps as f32 * step_s)
}
