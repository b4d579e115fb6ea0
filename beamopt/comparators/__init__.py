"""Methods that the charts hold against those shipped; on the same face as they."""
