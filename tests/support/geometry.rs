//! Obstacles by slow geometry in f64, from the words of the specification: the oracle of all
//! kernels that look at boxes.

pub type Point = [f64; 2];

/// A closed axis-aligned box on the ground, and how it moves.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle {
    pub centre: Point,
    pub half: Point,
    pub velocity: Point,
}

impl Obstacle {
    /// How deep a point lies inside, m: 0 on the boundary, negative outside.
    pub fn depth(&self, point: Point) -> f64 {
        let along = |i: usize| self.half[i] - (point[i] - self.centre[i]).abs();
        along(0).min(along(1))
    }

    /// After `time` between walls at `-side` and `side`.
    pub fn moved(self, time: f64, side: f64) -> Self {
        let moved = |i: usize| bounced(self.centre[i], self.velocity[i], time, side);
        let ((x, vx), (z, vz)) = (moved(0), moved(1));
        Obstacle {
            centre: [x, z],
            velocity: [vx, vz],
            ..self
        }
    }
}

/// How deep a point lies in the obstacle it is deepest in, m.
pub fn depth(obstacles: &[Obstacle], point: Point) -> f64 {
    let depths = obstacles.iter().map(|obstacle| obstacle.depth(point));
    depths.fold(f64::NEG_INFINITY, f64::max)
}

/// Whether it was rightly `found` that a point this deep lies inside; within `bar` of the boundary
/// either is right, and with a bar of 0 only what is.
pub fn right(found: bool, depth: f64, bar: f64) -> bool {
    depth.abs() < bar || found == (depth >= 0.0)
}

/// Place and velocity after `time`, from wall to wall.
pub fn bounced(mut place: f64, mut velocity: f64, mut time: f64, side: f64) -> (f64, f64) {
    loop {
        let wall = side.copysign(velocity);
        let until = (wall - place) / velocity;
        if velocity == 0.0 || until >= time {
            return (place + velocity * time, velocity);
        }
        (place, velocity, time) = (wall, -velocity, time - until);
    }
}

/// A place and a forward direction on the ground.
#[derive(Clone, Copy, Debug)]
pub struct Stance {
    pub at: Point,
    pub forward: Point,
}

impl Stance {
    /// Up crossed with forward.
    fn left(&self) -> Point {
        [self.forward[1], -self.forward[0]]
    }

    /// The world's point so far to the left and ahead.
    pub fn point(&self, left: f64, ahead: f64) -> Point {
        let sideways = self.left();
        [0, 1].map(|i| self.at[i] + left * sideways[i] + ahead * self.forward[i])
    }

    /// How far to the left and ahead a point of the world is.
    pub fn sees(&self, point: Point) -> [f64; 2] {
        let away = [point[0] - self.at[0], point[1] - self.at[1]];
        [self.left(), self.forward].map(|axis| axis[0] * away[0] + axis[1] * away[1])
    }

    /// Centre of a cell of the obstacle map: 16 x 16 over 6 x 6 m.
    pub fn cell(&self, row: usize, column: usize) -> Point {
        let [left, ahead] = [column, row].map(|cell| (cell as f64 - 7.5) * 0.375);
        self.point(left, ahead)
    }
}
