"""Strips of metal that join parts: outlines and strip become one part."""
