# docs/images/tone-curves.svg out of what atlas-bench-tone prints:
#   atlas-bench-tone > curves.txt && gnuplot benchmarks/tone/tone_curves.gp
set terminal svg size 640,360 font 'sans,12' background rgb 'white'
set output 'tone-curves.svg'
set xlabel 'luminance (log average 0.3, visible 99 % at 2, maximum 30)'
set ylabel 'display value'
set logscale x
set xrange [0.003:60]
set yrange [0:1.05]
set format x '%g'
set grid lc rgb '#e4e4e4'
set key left top
plot 'curves.txt' u 1:2 w l lw 2 lc rgb '#c8402a' t 'linear', \
     '' u 1:3 w l lw 2 lc rgb '#1f6fb4' t 'reinhard', \
     '' u 1:4 w l lw 2 lc rgb '#2e8b57' t 'drago', \
     '' u 1:5 w l lw 2 lc rgb '#d99000' t 'reinhard-devlin'
