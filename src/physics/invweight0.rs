//! How easily each body and each degree of freedom is moved at the start: what the regularisation of
//! constraints is measured in (MuJoCo's `body_invweight0` and `dof_invweight0`).

use super::dynamics::{inertias, mass_matrix};
use super::factor::{columns, factor, solve_lt};
use super::kinematics::{kinematics, origin};
use super::model::{JointKind, Model};
use super::pose::Pose;
use super::spatial::{Inertia, Spatial};
use glam::Vec3;

impl Model {
    /// Fills in the looseness of bodies and degrees of freedom.
    pub fn set_invweight0(&mut self) {
        let (bodies, dofs) = (self.bodies.len(), self.dofs.len());
        let (mut poses, mut axes) = (vec![Pose::default(); bodies], vec![Spatial::ZERO; dofs]);
        let mut carried = vec![Inertia::default(); bodies];
        let mut factors = vec![0.0; self.nm()];
        let columns = columns(self);
        let q = self.qpos0.clone();
        kinematics(self, &q, &mut poses, &mut axes);
        inertias(self, &q, &poses, &mut carried);
        mass_matrix(self, &axes, &mut carried, &mut factors);
        for dof in &self.dofs {
            factors[dof.row] += dof.armature;
        }
        factor(self, &columns, &mut factors);
        // J M^-1 J^T of one row.
        let response = |row: &[f32]| -> f32 {
            let mut x = row.to_vec();
            solve_lt(self, &columns, &factors, &mut x);
            x.iter().map(|x| x * x).sum()
        };
        let of_body = |index: usize| {
            let body = &self.bodies[index];
            let arm = poses[index].at(body.com) - origin(self, body.tree, &q);
            let along = |direction: Vec3| {
                let mut row = vec![0.0; dofs];
                for dof in self.dof_ancestors(body.last_dof) {
                    row[dof] = axes[dof].at(arm).dot(direction);
                }
                response(&row)
            };
            [Vec3::X, Vec3::Y, Vec3::Z].map(along).iter().sum::<f32>() / 3.0
        };
        let of_dof = |dof: usize| {
            let mut row = vec![0.0; dofs];
            row[dof] = 1.0;
            response(&row)
        };
        let loose_bodies: Vec<f32> = (0..bodies).map(of_body).collect();
        let mut loose_dofs: Vec<f32> = (0..dofs).map(of_dof).collect();
        for joint in &self.joints {
            // The axes of a turn, and those of a shift, share their mean.
            let group = if joint.kind == JointKind::Hinge { 1 } else { 3 };
            for group in loose_dofs[joint.v..][..joint.kind.nv()].chunks_mut(group) {
                let mean = group.iter().sum::<f32>() / group.len() as f32;
                group.fill(mean);
            }
        }
        for (body, invweight0) in self.bodies.iter_mut().zip(loose_bodies) {
            body.invweight0 = invweight0;
        }
        for (dof, invweight0) in self.dofs.iter_mut().zip(loose_dofs) {
            dof.invweight0 = invweight0;
        }
    }
}
