//! What the passes of a picture are drawn by: where the sun and the camera look.

use super::camera::Camera;
use bytemuck::{Pod, Zeroable};
use glam::camera::rh::proj::directx::orthographic;
use glam::camera::rh::view::look_at_mat4;
use glam::{Mat4, Vec3};

/// Side of the shadow map, pixels.
pub const SHADOWS: u32 = 2048;
/// Linear red, green and blue of the sky.
pub const SKY: [f64; 3] = [0.70, 0.77, 0.84];
/// Width of the shadows' soft edge, m.
const SOFT: f32 = 0.045;
/// Towards the sun.
const SUN: Vec3 = Vec3::new(-0.45, 0.80, 0.40);

/// `View` of `shaders/shared/light.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PassView {
    /// World to the clip space of the pass.
    pub clip: [[f32; 4]; 4],
    /// World to that of the shadow map.
    pub sunlit: [[f32; 4]; 4],
    /// Position of the camera, m.
    pub eye: [f32; 3],
    /// Distance in which half of everything is haze, m.
    pub haze: f32,
    /// Towards the sun, unit.
    pub sun: [f32; 3],
    /// Width of the shadows' soft edge as a fraction of the shadow map's side.
    pub soft: f32,
}

impl PassView {
    /// The sun's, for the shadows, then the camera's, for a picture `aspect` times as wide as high.
    pub fn of(camera: &Camera, aspect: f32) -> [PassView; 2] {
        let reach = 1.6 * camera.distance.max(2.5);
        let sunlit = sunlit(camera.focus, reach).to_cols_array_2d();
        let sun = PassView {
            clip: sunlit,
            sunlit,
            eye: camera.eye().to_array(),
            haze: 40.0 + 4.0 * camera.distance,
            sun: SUN.normalize().to_array(),
            // At least a pixel and a half, so that edges never show steps.
            soft: (SOFT / (2.0 * reach)).max(1.5 / SHADOWS as f32),
        };
        let clip = camera.clip(aspect).to_cols_array_2d();
        [sun, PassView { clip, ..sun }]
    }
}

/// World to the shadow map's clip space: a square of half side `reach` around `focus`. It moves in
/// whole pixels, so that edges do not crawl while the camera follows.
fn sunlit(focus: Vec3, reach: f32) -> Mat4 {
    let look = look_at_mat4(SUN.normalize(), Vec3::ZERO, Vec3::Y);
    let pixel = 2.0 * reach / SHADOWS as f32;
    let at = look.transform_point3(focus);
    let (x, y) = (
        (at.x / pixel).round() * pixel,
        (at.y / pixel).round() * pixel,
    );
    let depth = 2.0 * reach + 20.0;
    orthographic(
        x - reach,
        x + reach,
        y - reach,
        y + reach,
        -at.z - depth,
        -at.z + depth,
    ) * look
}
