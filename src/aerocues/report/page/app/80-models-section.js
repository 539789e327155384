/* Section 7: 3D models, shown where reconstruction results are present. */

addSection({
  id: "models",
  title: "3D",
  read: "The scene as each combination reconstructs it.",
  available: () => (payload.models ?? []).length > 0,
});
