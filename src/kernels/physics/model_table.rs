//! A compiled model and its solver options as words for the shaders; `shaders/shared/model_table.wgsl` names
//! every index.

use crate::gpu::shader::smooth_dynamics::constants as at;
use crate::physics::collision::PairKind;
use crate::physics::factor::columns;
use crate::physics::model::{Body, Dof, Joint, JointKind, Model, SolverParams};
use crate::physics::simulator::SolverOptions;

/// Contacts of a world that shaders have room for at most.
pub const CONTACT_BOUND: u32 = crate::gpu::shader::solve_and_integrate::constants::CONTACT_BOUND;

/// What does not fit a shader's fixed arrays.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the model has {found} {what}, but shaders hold no more than {most}; simulate it with `--device cpu`"
)]
pub struct TooLarge {
    what: &'static str,
    found: usize,
    most: usize,
}

/// A model and its solver options in words.
///
/// # Errors
/// A model too large for the shaders' arrays.
pub fn model_table(model: &Model, options: &SolverOptions) -> Result<Vec<u32>, TooLarge> {
    fits(model, options)?;
    let columns = columns(model);
    let mut words = vec![0; at::HEADER as usize];
    let mut section = |header: u32, section: Vec<u32>| {
        words[header as usize] = words.len() as u32;
        words.extend(section);
    };
    let bodies = model.bodies.iter();
    section(
        at::BODIES_AT,
        bodies.flat_map(|body| self::body(model, body)).collect(),
    );
    let joints = model.joints.iter();
    section(at::JOINTS_AT, joints.flat_map(joint).collect());
    section(at::DOFS_AT, dofs(model));
    section(at::COLUMNS_AT, columns.iter().map(|&c| c as u32).collect());
    section(at::TREES_AT, trees(model));
    section(at::PAIRS_AT, pairs(model));
    for (header, count) in [
        (at::BODY_COUNT, model.bodies.len()),
        (at::JOINT_COUNT, model.joints.len()),
        (at::DOF_COUNT, model.dofs.len()),
        (at::NM, columns.len()),
        (at::NQ, model.nq()),
        (at::TREE_COUNT, model.trees.len()),
        (at::MAX_CONTACTS, options.max_contacts),
        (at::ITERATIONS, options.iterations as usize),
        (at::QUADS, model.dofs.len().div_ceil(4)),
        (at::GEOM_COUNT, model.geoms.len()),
        (at::PLANE_CAPSULE, end(model, PairKind::PlaneCapsule)),
        (at::PLANE_BOX, end(model, PairKind::PlaneBox)),
        (at::CAPSULE_CAPSULE, end(model, PairKind::CapsuleCapsule)),
        (at::CAPSULE_BOX, end(model, PairKind::CapsuleBox)),
        (at::BOX_BOX, end(model, PairKind::BoxBox)),
    ] {
        words[header as usize] = count as u32;
    }
    Ok(words)
}

/// Where the pairs of a kind end.
fn end(model: &Model, of: PairKind) -> usize {
    let kind = |pair: &[usize; 2]| PairKind::of(pair.map(|geom| model.geoms[geom].shape));
    model.pairs.partition_point(|pair| kind(pair) <= of)
}

fn fits(model: &Model, options: &SolverOptions) -> Result<(), TooLarge> {
    use crate::gpu::shader::collision::constants as contact;
    use crate::gpu::shader::solve_and_integrate::constants as solve;
    let bodies = model.trees.iter().map(|tree| tree.bodies.len()).max();
    let dofs = model.trees.iter().map(|tree| tree.dofs.len()).max();
    let packed = model.trees.iter().map(|tree| {
        let depths = model.dofs[tree.dofs.clone()].iter().map(|dof| dof.depth);
        depths.sum()
    });
    for (what, found, most) in [
        ("bodies in a tree", bodies.unwrap_or(0), at::BODY_BOUND),
        (
            "entries in the mass matrix of a tree",
            packed.max().unwrap_or(0),
            at::NM_BOUND,
        ),
        (
            "degrees of freedom in a tree",
            dofs.unwrap_or(0),
            at::DOF_BOUND,
        ),
        ("degrees of freedom", model.dofs.len(), at::WORLD_DOF_BOUND),
        ("joints", model.joints.len(), solve::JOINT_BOUND),
        ("geoms", model.geoms.len(), contact::GEOM_BOUND),
        ("contacts", options.max_contacts, CONTACT_BOUND),
    ] {
        let most = most as usize;
        if found > most {
            return Err(TooLarge { what, found, most });
        }
    }
    Ok(())
}

fn body(model: &Model, body: &Body) -> Vec<u32> {
    let i = body.inertia;
    let mut words = vec![index(body.parent)];
    words.extend(reals(&body.position.to_array()));
    words.extend(reals(&body.rotation.to_array()));
    words.extend(reals(&[body.mass]));
    words.extend(reals(&body.com.to_array()));
    words.extend(reals(&[
        i.x_axis.x, i.y_axis.y, i.z_axis.z, i.y_axis.x, i.z_axis.x, i.z_axis.y,
    ]));
    words.extend([body.joints.start, body.joints.len()].map(|n| n as u32));
    words.extend([body.dofs.start, body.dofs.len()].map(|n| n as u32));
    words.extend(dof_mask(model, body));
    words
}

/// A bit for each degree of freedom that moves a body.
fn dof_mask(model: &Model, body: &Body) -> [u32; 3] {
    let mut bits = [0; 3];
    for dof in model.dof_ancestors(body.last_dof) {
        bits[dof / 32] |= 1 << (dof % 32);
    }
    bits
}

fn joint(joint: &Joint) -> Vec<u32> {
    let kind = match joint.kind {
        JointKind::Free => at::FREE,
        JointKind::Ball => at::BALL,
        JointKind::Hinge => at::HINGE,
    };
    let mut words = vec![kind, joint.q as u32, joint.v as u32];
    words.extend(reals(&joint.position.to_array()));
    words.extend(reals(&joint.axis.to_array()));
    words.push(u32::from(joint.range.is_some()));
    words.extend(reals(&joint.range.unwrap_or_default()));
    words.extend(solver_params(&joint.solver_params));
    words
}

fn dofs(model: &Model) -> Vec<u32> {
    let (mut words, mut driven) = (Vec::new(), 0..);
    let lasts = lasts(model);
    for (dof, last) in model.dofs.iter().zip(lasts) {
        words.extend(self::dof(dof, last));
        let target = at::DOF - at::DOF_TARGET;
        let index_of_target = words.len() - target as usize;
        words[index_of_target] = index(dof.drive.and_then(|_| driven.next()));
    }
    words
}

/// All words of a degree of freedom but the index of its target.
fn dof(dof: &Dof, last: usize) -> Vec<u32> {
    let row = [dof.depth, dof.row, dof.row + dof.depth, last];
    let mut words: Vec<u32> = row.map(|n| n as u32).to_vec();
    words.extend(reals(&[dof.armature]));
    words.push(at::NONE);
    let drive = dof.drive.map(|drive| {
        let [least, most] = drive.control;
        [
            drive.stiffness,
            drive.damping,
            drive.limit,
            drive.torque,
            least,
            most,
        ]
    });
    words.extend(reals(&drive.unwrap_or_default()));
    let spring = dof
        .spring
        .map(|spring| [spring.stiffness, spring.damping, spring.rest]);
    words.extend(reals(&spring.unwrap_or_default()));
    words.extend(reals(&[dof.invweight0]));
    words.push(dof.body as u32);
    words
}

/// One past the degrees of freedom that each moves: bodies stand right behind those that carry them.
fn lasts(model: &Model) -> Vec<usize> {
    let mut lasts: Vec<usize> = (1..=model.dofs.len()).collect();
    for index in (0..model.dofs.len()).rev() {
        if let Some(parent) = model.dofs[index].parent {
            lasts[parent] = lasts[parent].max(lasts[index]);
        }
    }
    lasts
}

fn trees(model: &Model) -> Vec<u32> {
    let words = model.trees.iter().flat_map(|tree| {
        let root = &model.bodies[tree.bodies.start];
        let first = model.joints[root.joints.clone()].first();
        let free = first.is_some_and(|joint| joint.kind == JointKind::Free);
        [
            tree.bodies.start,
            tree.bodies.len(),
            tree.dofs.start,
            tree.dofs.len(),
            usize::from(free),
        ]
    });
    words.map(|n| n as u32).collect()
}

fn pairs(model: &Model) -> Vec<u32> {
    let words = model.pairs.iter().flat_map(|&geoms| {
        let [first, second] = geoms.map(|geom| &model.geoms[geom]);
        let (friction, params) = first.mixed(second);
        let invweight0 = model.invweight0(first) + model.invweight0(second);
        let mut words = vec![index(first.body), index(second.body)];
        words.extend(reals(&[friction, invweight0]));
        words.extend(solver_params(&params));
        words.extend(geoms.map(|geom| geom as u32));
        words
    });
    words.collect()
}

fn index(index: Option<usize>) -> u32 {
    index.map_or(at::NONE, |index| index as u32)
}

fn reals(values: &[f32]) -> impl Iterator<Item = u32> {
    values.iter().map(|value| value.to_bits())
}

fn solver_params(params: &SolverParams) -> impl Iterator<Item = u32> {
    let values = params.solref.iter().chain(&params.solimp);
    values.map(|value| value.to_bits())
}
