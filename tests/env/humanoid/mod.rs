mod boxing;
mod latents;
mod mirrored;
mod scripts;
mod self_play;
mod skills;
mod stand;
mod style;
