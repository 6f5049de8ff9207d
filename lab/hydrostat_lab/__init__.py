"""Code that several studies share: methods of the thesis, methods of others, their comparison, tables and figures."""
