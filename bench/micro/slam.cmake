noctule_bench(slam ROOMS filters)
