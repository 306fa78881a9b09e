'use strict'; /* SPDX-License-Identifier: GPL-3.0-or-later */
/* Zoom of a chart: a range that is dragged over it becomes the page's `from` and `to`. The keys of arrows, +, - and 0
 * follow the links above it. */
(function () {
  document.querySelectorAll('figure.zoom').forEach(function (figure) {
    var svg = figure.querySelector('svg'), data = figure.dataset, start = null, mark = null, moved = false;
    var from = +data.from, to = +data.to;

    /* Place of the pointer between the chart's axes: 0 to 1. */
    function shareOf(event) {
      var box = svg.getBoundingClientRect(), x = (event.clientX - box.left) / box.width;
      return Math.min(1, Math.max(0, (x - data.left) / (data.right - data.left)));
    }

    function showRange(a, b) {
      var view = svg.viewBox.baseVal, width = (data.right - data.left) * view.width;
      if (!mark) {
        mark = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
        mark.setAttribute('class', 'chosen');
        mark.setAttribute('y', 0);
        mark.setAttribute('height', view.height);
        svg.appendChild(mark);
      }
      mark.setAttribute('x', data.left * view.width + Math.min(a, b) * width);
      mark.setAttribute('width', Math.abs(b - a) * width);
    }

    function dropRange() {
      if (mark) mark.remove();
      mark = null;
      start = null;
    }

    figure.addEventListener('dragstart', function (event) { event.preventDefault(); });
    figure.addEventListener('pointerdown', function (event) {
      if (event.button) return;
      start = shareOf(event);
      moved = false;
    });
    figure.addEventListener('pointermove', function (event) {
      if (start === null) return;
      var x = shareOf(event);
      if (!moved && Math.abs(x - start) < 0.01) return;
      if (!moved) {
        moved = true;
        figure.setPointerCapture(event.pointerId);
      }
      showRange(start, x);
    });
    figure.addEventListener('pointercancel', dropRange);
    figure.addEventListener('click', function (event) { if (moved) event.preventDefault(); }, true);
    figure.addEventListener('pointerup', function (event) {
      if (start === null) return;
      var a = start, b = shareOf(event);
      dropRange();
      if (!moved) return;
      var count = to - from + 1, url = new URL(location.href);
      var low = from + Math.floor(Math.min(a, b) * count), high = from + Math.ceil(Math.max(a, b) * count) - 1;
      low = Math.max(from, Math.min(low, to));
      high = Math.max(low, Math.min(high, to));
      url.searchParams.set('from', low);
      url.searchParams.set('to', high);
      location.href = url;
    });
  });

  document.addEventListener('keydown', function (event) {
    if (event.ctrlKey || event.altKey || event.metaKey || /INPUT|SELECT|TEXTAREA/.test(event.target.tagName)) return;
    var key = event.key === '=' ? '+' : event.key;
    var link = document.querySelector('[data-key="' + CSS.escape(key) + '"]');
    if (link) {
      event.preventDefault();
      location.href = link.href;
    }
  });
})();
