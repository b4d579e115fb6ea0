"""The judgement of sections: responses, tips, loss."""
