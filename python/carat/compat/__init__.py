"""The documented calls of other packages, answered by this one.

``import carat.compat.robust_laplacian as robust_laplacian`` and
``import carat.compat.potpourri3d as pp3d`` let scripts run that were written for those packages;
what they answer comes from carat's operators, on polygons as well as on triangles.
"""
