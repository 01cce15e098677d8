#!/bin/sh
# From drive logs to a plan, for any skid-steered robot:
#
#     examples/bag-to-plan.sh ROBOT TERRAIN START GOAL FOLDER LOG...
#
# ROBOT is `husky-a200` or a robot file of your own with what is known of it, TERRAIN a map that joulepath reads, START and GOAL are `X,Y` in
# metres or `@0.2,0.8`, FOLDER takes what is written, and LOG is a bag, a folder of `ros2 bag record`, an MCAP file or a table. Give two logs
# or more: each half is judged by the fit of the other. JOULEPATH names the program where it is not on the path.
set -eu

if [ $# -lt 6 ]; then
    sed -n '2,8s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
robot=$1 terrain=$2 start=$3 goal=$4 folder=$5
shift 5
joulepath=${JOULEPATH:-joulepath}
mkdir -p "$folder"

# 1. What is in the logs, and which map of topics and fields reads them. Look at it, and correct it where it is wrong: wheel radius,
#    units, signs.
"$joulepath" inspect "$1" --write-map "$folder/log-map.json"

# 2. How the robot as its file has it predicts these drives. What is doubtful about the logs is said here.
"$joulepath" predict --robot "$robot" --columns "$folder/log-map.json" --recording "$@"

# 3. The robot fitted to the drives. It is written only where nothing doubtful would explain the fit.
"$joulepath" calibrate --robot "$robot" --columns "$folder/log-map.json" --recording "$@" --out "$folder/robot.json"

# 4. A plan with the fitted robot, and what it will cost.
"$joulepath" plan --map "$terrain" --robot "$folder/robot.json" --start "$start" --goal "$goal" --json > "$folder/plan.json"
"$joulepath" compare --map "$terrain" --robot "$folder/robot.json" --start "$start" --goal "$goal"
