"""When a crack starts, on bare arrays."""
