# Sourced by scripts/demo and scripts/test: gives them a Python with ROS 2 Jazzy and a built
# package. Where ROS 2 Jazzy is sourced that is used; elsewhere its wheels go into a .venv here.
#
# In:  $requirements, the file to install; $newest, the newest Python 3 that it is for; $venv,
#      where to; $base, where colcon builds.
# Out: $python; the built package is on the environment.

say() { printf '==> %s\n' "$*" >&2; }
fail() { printf 'error: %s\n' "$*" >&2; exit 1; }

trap 'exit 130' INT  # not "is there a network connection?"

use_sourced_ros() {
    say "using ROS 2 Jazzy as sourced, with $(command -v "${PYTHON:-python3}")"
    python=${PYTHON:-python3}
    command -v colcon > /dev/null ||
        fail "colcon is missing: sudo apt install python3-colcon-common-extensions"
    "$python" -c 'import cv2, matplotlib, numpy, rclpy, scipy, tornado, tqdm, yaml' 2> /dev/null ||
        fail "rclpy, numpy, OpenCV, matplotlib, scipy, tornado, tqdm or yaml is missing: rosdep install --from-paths . --ignore-src -y"
}

check_python() {
    python=${PYTHON:-python3}
    command -v "$python" > /dev/null ||
        fail "no '$python' found: install Python 3.10 to 3.13, or name one: PYTHON=... $0"
    "$python" -c "import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, $newest))" \
        2> /dev/null ||
        fail "$("$python" --version 2>&1 | head -n 1) is not supported: name a Python 3.10 to" \
            "3.$newest: PYTHON=... $0"
    case "$("$python" -c 'import platform; print(platform.system(), platform.machine())')" in
        'Linux x86_64') ;;
        *) fail "the ROS 2 wheels exist for Linux on x86-64 only: install and source ROS 2 Jazzy" ;;
    esac
    "$python" -c 'import ensurepip, venv' 2> /dev/null ||
        fail "$python has no venv module: sudo apt install python3-venv, or name another: PYTHON=... $0"
}

use_wheels() {
    case $PWD in
        *[[:space:]]*) fail "colcon cannot work in '$PWD': move it to a path without spaces" ;;
    esac
    check_python
    # What another ROS or another wheel environment has left would be found before ours.
    unset PYTHONPATH PYTHONHOME AMENT_PREFIX_PATH COLCON_PREFIX_PATH
    if [ -n "${_ROS_WHEELS_BOOTSTRAP_COMPLETE:-}" ]; then
        unset _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH
    fi
    local stamp
    # A .venv holds the path that it was made for: a copied or moved one does not work.
    stamp=$(printf '%s\n' "$PWD"
        "$python" -c 'import sys; print(sys.base_prefix, sys.version)'; cat requirements*.txt)
    if [ "$(cat "$venv/ready" 2> /dev/null)" != "$stamp" ]; then
        say "making $venv with $("$python" --version)"
        rm -rf "$venv" "$base"/{build,install,log}
        "$python" -m venv "$venv" > /dev/null 2>&1 ||
            fail "cannot make $venv with $python: is the disk full, or python3-venv missing?"
        say "installing $requirements into $venv (once, about a minute)"
        "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --retries 2 \
            --timeout 15 --only-binary numpy,opencv-python-headless \
            -r "$requirements" > "$venv/pip.log" 2>&1 ||
            fail "cannot install $requirements: is there a network connection? pip says:" \
                "$(grep -i error "$venv/pip.log" | tail -n 1)"
        # colcon finds no package in it, and does not warn that the second is missing.
        touch "$venv/COLCON_IGNORE" "$venv/local_setup.sh"
        printf '%s' "$stamp" > "$venv/ready"
    fi
    python=$PWD/$venv/bin/python
    export PATH=$PWD/$venv/bin:$PATH AMENT_PREFIX_PATH=$PWD/$venv
}

build() {
    # A copied or moved build would install into the folder that it was made in.
    local made_in=$base/build/made_in
    if [ -e "$made_in" ] && [ "$(cat "$made_in")" != "$PWD" ]; then
        rm -rf "$base"/{build,install,log}
    fi
    say "building the package"
    mkdir -p "$base/log" "$base/build"
    printf '%s' "$PWD" > "$made_in"
    colcon --log-base "$base/log" build --build-base "$base/build" \
        --install-base "$base/install" > "$base/log/build.log" 2>&1 ||
        { tail -n 20 "$base/log/build.log" >&2; fail "colcon build failed, see above"; }
    set +u  # colcon's scripts read variables that are not set
    . "$base/install/local_setup.bash"
    set -u
}

[ -n "${HOME:-}" ] && [ -w "$HOME" ] || export ROS_LOG_DIR=$PWD/$base/log/ros

if [ "${ROS_DISTRO:-}" = jazzy ] && [ -n "${AMENT_PREFIX_PATH:-}" ]; then
    use_sourced_ros
else
    use_wheels
fi
build
