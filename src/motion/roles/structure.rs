//! Roles by the form of the tree: two like legs hang from the hips, two like arms from the trunk.

use crate::motion::sides::side;
use crate::motion::skeleton::Skeleton;
use glam::Vec3;

/// Lengths of two like limbs differ by less than this fraction.
const LIKENESS: f32 = 0.2;

/// The two long bones of a limb make up this fraction of all that hangs on its top, at least.
const LONG: f32 = 0.55;

/// How far to its side a limb lies, as a fraction of the distance to its like.
const BESIDE: f32 = 0.5;

/// Only the forks with the longest limbs are compared.
const FORKS: usize = 16;

/// The joints of hips, left and right hip, foot, toe and shoulder, in the order of
/// [`ROLES`](super::ROLES); none where the tree is not a person's or its sides cannot be told.
pub fn find(skeleton: &Skeleton) -> Option<[usize; 9]> {
    let tree = Tree::of(skeleton);
    let forks = tree.forks();
    let pairs = forks
        .iter()
        .flat_map(|legs| forks.iter().map(move |arms| (legs, arms)));
    let bodies = pairs.filter_map(|(legs, arms)| Some((tree.hips(legs, arms)?, legs, arms)));
    let size = |legs: &Fork, arms: &Fork| legs.length() + arms.length();
    let (hips, legs, arms) = bodies.max_by(|a, b| size(a.1, a.2).total_cmp(&size(b.1, b.2)))?;
    let mut roles = [hips; 9];
    let sides = Sides::of(skeleton, legs, arms);
    let [[left, right], arms] = [legs, arms].map(|fork| sides.left_first(fork));
    let toe = |limb: &Limb| tree.main[limb.end].unwrap_or(limb.end);
    (roles[1], roles[2]) = (left?.top, right?.top);
    (roles[3], roles[4]) = (left?.end, right?.end);
    (roles[5], roles[6]) = (toe(left?), toe(right?));
    (roles[7], roles[8]) = (arms[0]?.top, arms[1]?.top);
    Some(roles)
}

/// The lowest joint on which all of these hang, or which is one of them.
pub fn common_ancestor(skeleton: &Skeleton, joints: &[usize]) -> Option<usize> {
    joints.iter().copied().reduce(|mut a, mut b| {
        // Parents come before their children: the later one cannot carry the other.
        while a != b {
            let later = a.max(b);
            (a, b) = (a.min(b), skeleton.parents[later].unwrap_or_default());
        }
        a
    })
}

/// The next two joints below the top of a limb: elbow and hand, knee and foot.
pub fn limb_below(skeleton: &Skeleton, top: usize) -> Option<[usize; 2]> {
    let tree = Tree::of(skeleton);
    let middle = tree.main[top]?;
    Some([middle, tree.main[middle]?])
}

/// Two long bones in a row.
struct Limb {
    top: usize,
    middle: usize,
    end: usize,
    length: f32,
}

/// A joint on which two like limbs hang.
struct Fork {
    joint: usize,
    limbs: [Limb; 2],
}

impl Fork {
    fn length(&self) -> f32 {
        self.limbs[0].length.min(self.limbs[1].length)
    }
}

struct Tree<'a> {
    skeleton: &'a Skeleton,
    children: Vec<Vec<usize>>,
    /// The child on the longest way down, if there is one.
    main: Vec<Option<usize>>,
    /// Length of that way.
    reach: Vec<f32>,
}

impl<'a> Tree<'a> {
    fn of(skeleton: &'a Skeleton) -> Tree<'a> {
        let joints = skeleton.joints();
        let mut tree = Tree {
            skeleton,
            children: vec![Vec::new(); joints],
            main: vec![None; joints],
            reach: vec![0.0; joints],
        };
        // Children come after their parents.
        for joint in (1..joints).rev() {
            let Some(parent) = skeleton.parents[joint] else {
                continue;
            };
            tree.children[parent].push(joint);
            let reach = tree.reach[joint] + skeleton.offsets[joint].length();
            if tree.main[parent].is_none() || reach >= tree.reach[parent] {
                (tree.main[parent], tree.reach[parent]) = (Some(joint), reach);
            }
        }
        tree
    }

    /// The forks with the longest limbs.
    fn forks(&self) -> Vec<Fork> {
        let joints = (0..self.children.len()).filter(|&joint| self.children[joint].len() > 1);
        let mut forks: Vec<Fork> = joints.filter_map(|joint| self.fork(joint)).collect();
        forks.sort_by(|a, b| b.length().total_cmp(&a.length()));
        forks.truncate(FORKS);
        forks
    }

    fn fork(&self, joint: usize) -> Option<Fork> {
        let limbs = self.children[joint].iter().rev();
        let mut limbs: Vec<Limb> = limbs.filter_map(|&child| self.limb(child)).collect();
        limbs.sort_by(|a, b| b.length.total_cmp(&a.length));
        let like = |pair: &[Limb]| pair[1].length >= (1.0 - LIKENESS) * pair[0].length;
        let first = limbs.windows(2).position(like)?;
        let pair = limbs.into_iter().skip(first).take(2);
        let limbs = pair.collect::<Vec<_>>().try_into().ok()?;
        Some(Fork { joint, limbs })
    }

    /// The longest two bones in a row on the longest way down from a joint.
    fn limb(&self, child: usize) -> Option<Limb> {
        let way = std::iter::successors(Some(child), |&joint| self.main[joint]);
        let way: Vec<usize> = way.collect();
        let bone = |joint: usize| self.skeleton.offsets[joint].length();
        let limbs = way.windows(3).map(|joints| Limb {
            top: joints[0],
            middle: joints[1],
            end: joints[2],
            length: bone(joints[1]) + bone(joints[2]),
        });
        let longest = limbs.max_by(|a, b| a.length.total_cmp(&b.length))?;
        (longest.length > 0.0 && longest.length >= LONG * self.reach[longest.top])
            .then_some(longest)
    }

    /// The joint that carries both, if these can be the legs and the arms of a person.
    fn hips(&self, legs: &Fork, arms: &Fork) -> Option<usize> {
        let hips = common_ancestor(self.skeleton, &[legs.joint, arms.joint])?;
        let limbs = |fork: &Fork| [fork.limbs[0].end, fork.limbs[1].end];
        let all = [limbs(legs), limbs(arms)].concat();
        let apart = (0..all.len()).all(|i| {
            (0..i).all(|j| {
                let fork = common_ancestor(self.skeleton, &[all[i], all[j]]);
                fork.is_some_and(|fork| fork != all[i] && fork != all[j])
            })
        });
        let in_order = hips == legs.joint || legs.length() > arms.length();
        (apart && legs.joint != arms.joint && hips != arms.joint && in_order).then_some(hips)
    }
}

/// What tells left from right: names, else where the limbs lie in the rest pose.
struct Sides<'a> {
    skeleton: &'a Skeleton,
    rest: Vec<Vec3>,
    /// Unit vector to the left of the rest pose, zero if that cannot be told.
    left: Vec3,
}

impl<'a> Sides<'a> {
    fn of(skeleton: &'a Skeleton, legs: &Fork, arms: &Fork) -> Sides<'a> {
        let identity = vec![glam::Quat::IDENTITY; skeleton.joints()];
        let (rest, _) = skeleton.world(Vec3::ZERO, &identity);
        let middle = |joints: [usize; 2]| (rest[joints[0]] + rest[joints[1]]) / 2.0;
        let tops = |fork: &Fork| middle([fork.limbs[0].top, fork.limbs[1].top]);
        let ends = |fork: &Fork| middle([fork.limbs[0].end, fork.limbs[1].end]);
        let up = (tops(arms) - tops(legs)).normalize_or_zero();
        let down = (ends(legs) - tops(legs)).normalize_or_zero();
        let tips = |limb: &Limb| {
            let toes = skeleton.parents.iter().position(|&p| p == Some(limb.end));
            toes.map_or(Vec3::ZERO, |toe| rest[toe] - rest[limb.end])
        };
        let forward = tips(&legs.limbs[0]) + tips(&legs.limbs[1]);
        // Only a rest pose that stands says anything.
        let left = match up.dot(down) < -0.9 {
            true => up.cross(forward).normalize_or_zero(),
            false => Vec3::ZERO,
        };
        Sides {
            skeleton,
            rest,
            left,
        }
    }

    fn left_first<'b>(&self, fork: &'b Fork) -> [Option<&'b Limb>; 2] {
        let [a, b] = &fork.limbs;
        match self.named_left(a, b).or_else(|| self.lies_left(a, b)) {
            Some(true) => [Some(a), Some(b)],
            Some(false) => [Some(b), Some(a)],
            None => [None, None],
        }
    }

    /// Whether `a` is the left one by the names of two joints that correspond.
    fn named_left(&self, a: &Limb, b: &Limb) -> Option<bool> {
        let joints = [(a.top, b.top), (a.middle, b.middle), (a.end, b.end)];
        joints.into_iter().find_map(|(a, b)| {
            let [a, b] = [a, b].map(|joint| &*self.skeleton.names[joint]);
            match side(a) {
                Some(sided) if sided.other == b => Some(sided.left),
                _ => first_letters(a, b),
            }
        })
    }

    fn lies_left(&self, a: &Limb, b: &Limb) -> Option<bool> {
        let apart = self.rest[a.top] - self.rest[b.top];
        let beside = apart.dot(self.left);
        (beside.abs() > BESIDE * apart.length()).then_some(beside > 0.0)
    }
}

/// Whether `a` is the left one of names like `lfemur` and `rfemur`.
fn first_letters(a: &str, b: &str) -> Option<bool> {
    let (mut a, mut b) = (a.chars(), b.chars());
    let letters = [a.next()?, b.next()?].map(|c| c.to_ascii_lowercase());
    match (letters, a.eq(b)) {
        (['l', 'r'], true) => Some(true),
        (['r', 'l'], true) => Some(false),
        _ => None,
    }
}
