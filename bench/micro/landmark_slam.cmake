noctule_bench(landmark_slam ROOMS filters)
