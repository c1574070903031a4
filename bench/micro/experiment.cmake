noctule_bench(experiment ROOMS experiment)
