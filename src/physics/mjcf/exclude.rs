//! Which geoms may touch: all those that neither their kinds nor their bodies keep apart.

use super::element::Element;
use super::error::Checked;
use super::grammar::{CONTACT, EXCLUDE};
use super::worldbody::WorldBuilder;
use crate::physics::collision::PairKind;
use crate::physics::model::{Geom, GeomShape};
use std::collections::HashSet;

impl<'a> WorldBuilder<'a> {
    pub fn pairs(&mut self, root: &Element<'a>) {
        let apart = self.excluded(root);
        let geoms = self.model.geoms.len();
        let all = (0..geoms).flat_map(|a| (a + 1..geoms).map(move |b| [a, b]));
        let may: Vec<[usize; 2]> = all.filter(|&pair| self.may_touch(pair, &apart)).collect();
        self.model.pairs = ordered(&self.model.geoms, may);
    }

    fn may_touch(&self, pair: [usize; 2], apart: &HashSet<[usize; 2]>) -> bool {
        let [a, b] = pair.map(|geom| self.touching[geom]);
        let (first, second) = (&self.elements[a.0], &self.elements[b.0]);
        // The bodies that those welded together hang on.
        let above = |weld: usize| self.elements[self.elements[weld].parent].weld;
        let relatives = above(first.weld) == second.weld || above(second.weld) == first.weld;
        let moving = first.weld != 0 && second.weld != 0;
        a.1.meet(b.1)
            && first.weld != second.weld
            && !(moving && relatives)
            && !apart.contains(&[a.0, b.0])
    }

    /// Pairs of elements, both ways round.
    fn excluded(&mut self, root: &Element<'a>) -> HashSet<[usize; 2]> {
        let mut apart = HashSet::new();
        for child in root.within("contact", &CONTACT) {
            child.check(&EXCLUDE);
            self.name(&child);
            let bodies = ["body1", "body2"].map(|name| child.keep(self.named(&child, name)));
            if let [Some(Some(a)), Some(Some(b))] = bodies {
                apart.extend([[a, b], [b, a]]);
            }
        }
        apart
    }

    /// The body that an attribute names; none if it may be one that could not be read.
    fn named(&self, element: &Element, attribute: &str) -> Checked<Option<usize>> {
        let name = element.naming(attribute)?;
        if name == "world" {
            return Ok(Some(0));
        }
        let mut names = self.elements.iter().map(|known| known.element.name());
        match names.position(|known| known == name) {
            None if self.named_all("body") => {
                Err(element.wrong(attribute, "there is no such body"))
            }
            body => Ok(body),
        }
    }
}

/// Pairs in the model's order: each family together, so that shaders take one after another.
pub fn ordered(geoms: &[Geom], pairs: Vec<[usize; 2]>) -> Vec<[usize; 2]> {
    let turned = |[a, b]: [usize; 2]| match rank(&geoms[a]) <= rank(&geoms[b]) {
        true => [a, b],
        false => [b, a],
    };
    let mut pairs: Vec<[usize; 2]> = pairs.into_iter().map(turned).collect();
    pairs.sort_by_key(|pair| PairKind::of(pair.map(|geom| geoms[geom].shape)));
    pairs
}

/// The shape's index in [`GeomShape`].
fn rank(geom: &Geom) -> usize {
    match geom.shape {
        GeomShape::Plane => 0,
        GeomShape::Sphere { .. } => 1,
        GeomShape::Capsule { .. } => 2,
        GeomShape::Box { .. } => 3,
    }
}
