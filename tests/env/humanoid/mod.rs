mod mirrored;
mod stand;
mod style;
