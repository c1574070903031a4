# OpenCV's KCF and CSRT beside ours, through the same wrapper as in experiments.
noctule_bench(visual_tracking ROOMS experiment sensors sim)
