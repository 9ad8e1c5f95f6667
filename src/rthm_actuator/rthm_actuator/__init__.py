"""Controller, compensators and safety monitor of a hybrid test."""
