//! Pictures of what a character does: a scene in plain data, and the renderer that draws it into a
//! texture, for a window or for a file (feature `viewer`).

#[cfg(feature = "viewer")]
pub mod body_crowd;
#[cfg(feature = "viewer")]
pub mod body_film;
pub mod body_grip;
pub mod body_playthrough;
pub mod body_scene;
pub mod bout_bars;
pub mod bout_scene;
pub mod camera;
#[cfg(feature = "viewer")]
pub mod crowd;
#[cfg(feature = "viewer")]
mod crowd_shape;
pub mod debug_draw;
#[cfg(feature = "viewer")]
pub mod film;
#[cfg(feature = "viewer")]
pub mod image_files;
pub mod latent_map;
pub mod latent_path;
#[cfg(feature = "viewer")]
pub mod latent_strips;
#[cfg(feature = "viewer")]
pub mod locomotion_film;
pub mod own_fighter;
#[cfg(feature = "viewer")]
pub mod painter;
#[cfg(feature = "viewer")]
pub mod policy_film;
pub mod recorded_bout;
pub mod reference;
#[cfg(feature = "viewer")]
pub mod render_target;
#[cfg(feature = "viewer")]
pub mod renderer;
pub mod scene;
pub mod shapes;
pub mod sphere;
#[cfg(feature = "viewer")]
pub mod strip;
pub mod sunlight;

#[cfg(feature = "viewer")]
pub use body_crowd::BodyCrowd;
pub use camera::Camera;
#[cfg(feature = "viewer")]
pub use crowd::Crowd;
#[cfg(feature = "viewer")]
pub use render_target::RenderTarget;
#[cfg(feature = "viewer")]
pub use renderer::Renderer;
pub use scene::Scene;
