//! Curves of a body in motion: minimum-jerk moves, added up.

/// A number over time that rests, moves and rests again.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    start: f32,
    moves: Vec<Move>,
}

#[derive(Clone, Copy, Debug)]
struct Move {
    from: f32,
    to: f32,
    by: f32,
}

impl Curve {
    pub fn resting_at(start: f32) -> Curve {
        Curve {
            start,
            moves: Vec::new(),
        }
    }

    /// Moves by so much between two moments (s), on top of whatever else moves it then.
    pub fn go(&mut self, (from, to): (f32, f32), by: f32) {
        self.moves.push(Move { from, to, by });
    }

    /// Moves to where it is to be.
    pub fn arrive(&mut self, span: (f32, f32), goal: f32) {
        self.go(span, goal - self.end());
    }

    /// Moves by so much and, later, back again.
    pub fn visit(&mut self, there: (f32, f32), back: (f32, f32), by: f32) {
        self.go(there, by);
        self.go(back, -by);
    }

    pub fn at(&self, time: f32) -> f32 {
        let done = |m: &Move| m.by * minimum_jerk((time - m.from) / (m.to - m.from));
        self.start + self.moves.iter().map(done).sum::<f32>()
    }

    /// Where it comes to rest.
    pub fn end(&self) -> f32 {
        self.at(f32::INFINITY)
    }
}

/// 0 below 0, 1 above 1, and between them the way of the least jerk (Flash and Hogan, 1985).
pub fn minimum_jerk(s: f32) -> f32 {
    let x = s.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}
