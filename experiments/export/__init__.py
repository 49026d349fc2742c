"""A scene's camera, depth and conventions, for whoever matches it with another engine."""

from experiments.export.folder import check_folder, write_export

__all__ = ["check_folder", "write_export"]
