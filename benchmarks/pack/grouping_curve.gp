# docs/images/packing-grouping.svg out of what atlas-bench-grouping prints:
#   atlas-bench-grouping > curve.txt && gnuplot benchmarks/pack/grouping_curve.gp
set terminal svg size 720,360 font 'sans,12' background rgb 'white'
set output 'packing-grouping.svg'
set xlabel 'capacity A, texels of a page'
set ylabel 'groups F(A)'
set ytics 1
set yrange [5.6:9.4]
set xrange [6900:11900]
set grid lc rgb '#e4e4e4'
set arrow from 6900,8 to 11900,8 nohead dt 2 lc rgb '#909090'
set label 'N = 8' at 11850,8.15 right tc rgb '#606060'
plot 'curve.txt' i 0 w steps lw 2 lc rgb '#1f6fb4' t 'F(A)', \
     '' i 1 w p pt 7 ps 0.7 lc rgb '#c8402a' t 'evaluated by the bisection'
