mod stand;
mod style;
