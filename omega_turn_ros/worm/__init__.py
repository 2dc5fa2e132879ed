"""From recordings of worms to gaits: kymographs, their principal components, their two waves."""
