"""How long a diagnosis takes."""
