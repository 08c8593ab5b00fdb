"""What authors of rules, profiles and dialects have: pages, checks, drafts, trials."""
