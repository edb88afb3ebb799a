// node drive.js ADDRESS NAMESPACE: as a page that somebody has written with roslibjs.

import * as ROSLIB from "roslib";

const [url, namespace] = process.argv.slice(2);
const ros = new ROSLIB.Ros({ url });
const turtle = `${namespace}/turtle1`;

function end(error) {
  if (error) console.error(error);
  process.exit(error ? 1 : 0);
}

const asked = (ask) => new Promise((done, fail) => { ask(done, fail); });

/** Commands until it has come as far as x [m] and stands: a late one would abort what follows. */
function driveTo(x) {
  const pose = new ROSLIB.Topic({ ros, name: `${turtle}/pose`, messageType: "turtlesim/msg/Pose" });
  const velocity = new ROSLIB.Topic({
    ros, name: `${turtle}/cmd_vel`, messageType: "geometry_msgs/msg/Twist",
  });
  let hasStopped = false;
  return new Promise((done) => {
    pose.subscribe((told) => {
      if (!hasStopped) {
        hasStopped = told.x > x;
        velocity.publish({ linear: { x: hasStopped ? 0 : 2 } });
      } else if (told.linear_velocity === 0) {
        pose.unsubscribe();
        done();
      }
    });
  });
}

function setPen() {
  const pen = new ROSLIB.Service({
    ros, name: `${turtle}/set_pen`, serviceType: "turtlesim/srv/SetPen",
  });
  return asked((done, fail) => pen.callService({ r: 255, g: 0, b: 0, width: 5, off: 0 }, done, fail));
}

function turn(theta) {
  const action = new ROSLIB.Action({
    ros, name: `${turtle}/rotate_absolute`, actionType: "turtlesim/action/RotateAbsolute",
  });
  return asked((done, fail) => action.sendGoal({ theta }, done, () => {}, fail));
}

ros.on("error", end);
ros.on("connection", async () => {
  const { topics } = await asked((done, fail) => ros.getTopics(done, fail));
  console.log("topics", topics.includes(`${turtle}/pose`));
  await driveTo(6.5);
  console.log("pen", Object.keys(await setPen()).length);
  await driveTo(7);
  console.log("turned", Math.abs((await turn(1)).delta) > 0.9);
  end();
});
