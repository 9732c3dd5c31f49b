mod boxing;
mod latents;
mod mirrored;
mod self_play;
mod skills;
mod stand;
mod style;
