"""The paper's movements as scenarios, and what it takes to run and judge them."""
