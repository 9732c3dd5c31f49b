//! Pictures of what a character does: a scene in plain data, and the renderer that draws it into a
//! texture, for a window or for a file.

pub mod body_crowd;
pub mod body_film;
pub mod body_playthrough;
pub mod body_scene;
pub mod bout_bars;
pub mod bout_scene;
pub mod camera;
pub mod crowd;
mod crowd_shape;
pub mod debug_draw;
pub mod image_files;
pub mod latent_map;
pub mod latent_path;
pub mod latent_strips;
pub mod own_fighter;
pub mod painter;
pub mod recorded_bout;
pub mod reference;
pub mod render_target;
pub mod renderer;
pub mod scene;
pub mod shapes;
pub mod sphere;
pub mod strip;

pub use body_crowd::BodyCrowd;
pub use camera::Camera;
pub use crowd::Crowd;
pub use render_target::RenderTarget;
pub use renderer::Renderer;
pub use scene::Scene;
