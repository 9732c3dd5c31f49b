//! Pictures of what a character does: a scene in plain data, and the renderer that draws it into a
//! texture, for a window or for a file.

pub mod capsule_rig;
pub mod camera;
pub mod render_target;
pub mod crowd;
pub mod image_files;
pub mod meshes;
pub mod debug_draw;
pub mod painter;
pub mod renderer;
pub mod playthrough;
pub mod scene;
pub mod shapes;
pub mod strip;

pub use camera::Camera;
pub use render_target::RenderTarget;
pub use crowd::Crowd;
pub use renderer::Renderer;
pub use scene::Scene;
