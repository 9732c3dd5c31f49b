//! Pictures of what a character does: a scene in plain data, and the renderer that draws it into a
//! texture, for a window or for a file.

pub mod body;
pub mod camera;
pub mod canvas;
pub mod crowd;
pub mod film;
pub mod marks;
pub mod painter;
pub mod renderer;
pub mod rollout;
pub mod scene;
pub mod shapes;
pub mod strip;

pub use camera::Camera;
pub use canvas::Canvas;
pub use crowd::Crowd;
pub use renderer::Renderer;
pub use scene::Scene;
