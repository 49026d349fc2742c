"""Why a scene can have no reference: before the estimate where it is certain, else from what came of it."""
