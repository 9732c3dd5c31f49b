mod latents;
mod mirrored;
mod stand;
mod style;
