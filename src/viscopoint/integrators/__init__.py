"""How bodies are taken through time."""
