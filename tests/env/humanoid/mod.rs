mod stand;
