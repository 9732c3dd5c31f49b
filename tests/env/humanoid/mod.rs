mod boxing;
mod latents;
mod mirrored;
mod skills;
mod stand;
mod style;
