"""The paper's comparison of methods: three targets, four combinations, several iterations."""
