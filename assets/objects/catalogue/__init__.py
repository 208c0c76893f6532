"""Recipes of the catalogue objects, a chapter per kind of thing."""
