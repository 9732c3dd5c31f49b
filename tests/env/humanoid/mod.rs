mod boxing;
mod mirrored;
mod stand;
mod style;
