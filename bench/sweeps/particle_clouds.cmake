noctule_sweep(particle_clouds ROOMS particle models report)
