"""What runs beside a submission, one folder a scene."""
