"""A plant's profile: its sections, how it is read, checked and written, and the profiles that are shipped."""
