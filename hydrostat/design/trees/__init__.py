"""The thesis's way to a network: strong muscle fibres, joined to winch trees."""
